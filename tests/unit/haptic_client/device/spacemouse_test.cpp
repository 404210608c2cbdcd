// A SpaceMouse over a port in memory, in virtual time.
#include "haptic_client/device/spacemouse.h"

#include <deque>
#include <vector>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

using Report = std::array<std::byte, 7>;

Report push(int x, int y, int z) {
  Report report{std::byte{1}};
  std::size_t at = 1;
  for (const int axis : {x, y, z}) {
    report[at++] = static_cast<std::byte>(axis & 0xff);
    report[at++] = static_cast<std::byte>(axis >> 8 & 0xff);
  }
  return report;
}

/// What the port was told and what it will say; outlives the device that owns the port.
struct Line {
  std::deque<Report> reports;
  std::vector<std::vector<std::byte>> lights;
  UsbTransport::State state = UsbTransport::State::kClosed;
  bool plugged = true;
  int opens = 0, closes = 0;
};

class MemoryPort : public UsbTransport {
 public:
  explicit MemoryPort(Line& line) : line_(line) {}
  bool open(Time) noexcept override {
    ++line_.opens;
    if (line_.plugged) line_.state = State::kIdle;
    return line_.plugged;
  }
  void close() noexcept override {
    ++line_.closes;
    line_.state = State::kClosed;
  }
  void control(const UsbRequest& request) noexcept override {
    if (line_.state != State::kIdle) return;
    CHECK(request.type == 0x21);
    CHECK(request.request == 9);
    CHECK(request.value == 0x0204);
    line_.lights.emplace_back(request.data.begin(), request.data.end());
  }
  bool write(std::span<const std::byte>) noexcept override { return false; }
  std::size_t read(std::span<std::byte> out) noexcept override {
    if (line_.state != State::kIdle || line_.reports.empty()) return 0;
    const Report report = line_.reports.front();
    line_.reports.pop_front();
    std::ranges::copy(report, out.begin());
    return report.size();
  }
  State state() const noexcept override { return line_.state; }
  /// Lost: unplugged, then; and where it is closed, somebody has locked it.
  const char* trouble() const noexcept override {
    return line_.plugged || line_.state == State::kLost ? "" : "no permission";
  }

 private:
  Line& line_;
};

constexpr double kSpeed = 0.2, kReach = 0.15;  // m/s, m
constexpr Time kTick = 2ms;

struct Desk {
  Line line;
  std::unique_ptr<SpaceMouse> mouse = std::make_unique<SpaceMouse>(
      std::make_unique<MemoryPort>(line), SpaceMouseSettings{.speed = kSpeed, .reach = kReach});
  Time now = 5s;

  /// Ticks for so long; the mouse repeats its report every 8 ms, as the real one does.
  DeviceReading hold(const Report& report, Time duration) {
    DeviceReading reading;
    for (const Time end = now + duration; now < end; now += kTick) {
      if (now.count() % (8ms).count() == 0) line.reports.push_back(report);
      reading = mouse->read(now);
    }
    return reading;
  }
  DeviceReading silent(Time duration) {
    DeviceReading reading;
    for (const Time end = now + duration; now < end; now += kTick) reading = mouse->read(now);
    return reading;
  }
};

}  // namespace

TEST_CASE("SpaceMouse: constant deflection is constant velocity, from the first report on") {
  Desk desk;
  CHECK(desk.mouse->read(desk.now).p_D == Vec3::Zero());
  // 180 raw is a quarter of full speed; raw z is down, raw y towards the user.
  const DeviceReading reading = desk.hold(push(350, 180, -180), 400ms + kTick);
  CHECK(reading.valid);
  CHECK((reading.p_D - 0.4 * kSpeed * Vec3(1, 0.25, 0.25)).norm() < 1e-12);
}

TEST_CASE("SpaceMouse: in the dead band nothing drifts, not by a bit") {
  Desk desk;
  const Vec3 before = desk.hold(push(350, 0, 0), 100ms).p_D;
  desk.hold(push(10, -10, 10), kTick);  // the tick that brings the report still moves as before
  const Vec3 still = desk.silent(kTick).p_D;
  CHECK(still[0] > before[0]);
  CHECK(desk.hold(push(10, -10, 10), 60s).p_D == still);
}

TEST_CASE("SpaceMouse: a silence of more than 100 ms is standing still") {
  Desk desk;
  desk.hold(push(0, 350, 0), kTick);
  CHECK(desk.silent(5s).p_D[2] == Approx(kSpeed * 0.1).epsilon(1e-12));
  // A loop that stalled counts no longer either.
  desk.line.reports.push_back(push(0, 350, 0));
  desk.mouse->read(desk.now);
  CHECK(desk.mouse->read(desk.now + 10s).p_D[2] == Approx(kSpeed * 0.2).epsilon(1e-12));
}

TEST_CASE("SpaceMouse: the tool stays in its box and comes back from its wall at once") {
  Desk desk;
  CHECK(desk.hold(push(350, 0, -350), 5s).p_D == Vec3(kReach, kReach, 0));
  const Vec3 back = desk.hold(push(-350, 0, 0), 100ms).p_D;
  CHECK(back[0] == Approx(kReach - kSpeed * 0.098).margin(1.1 * kSpeed * to_seconds(8ms)));
  CHECK(back[1] == kReach);
}

TEST_CASE("SpaceMouse: unplugged it is invalid and says so, plugged in again it goes on where it was") {
  Desk desk;
  desk.hold(push(350, 0, 0), 200ms);
  CHECK(std::string(desk.mouse->status()).find("ready") != std::string::npos);
  const Vec3 before = desk.mouse->read(desk.now).p_D;
  desk.line.state = UsbTransport::State::kLost;
  desk.line.plugged = false;
  CHECK_FALSE(desk.mouse->read(desk.now).valid);
  CHECK(std::string(desk.mouse->status()).find("unplugged") != std::string::npos);
  CHECK_FALSE(desk.silent(2s).valid);
  CHECK(std::string(desk.mouse->status()) == "no permission");
  desk.line.plugged = true;
  const DeviceReading after = desk.silent(1s);
  CHECK(after.valid);
  CHECK(after.p_D == before);
  CHECK(desk.hold(push(-350, 0, 0), 100ms).p_D[0] < before[0]);
}

TEST_CASE("SpaceMouse: its light is on while it is open") {
  using Light = std::vector<std::byte>;
  const Light on{std::byte{4}, std::byte{1}}, off{std::byte{4}, std::byte{0}};
  Desk desk;
  desk.silent(100ms);
  CHECK(desk.line.lights == std::vector<Light>{on});
  desk.mouse.reset();
  CHECK(desk.line.lights == std::vector<Light>{on, off});
  CHECK(desk.line.state == UsbTransport::State::kClosed);
}

TEST_CASE("SpaceMouse: a tick takes no memory") {
  Desk desk;
  desk.silent(10ms);
  for (int i = 0; i < 100; ++i) desk.line.reports.push_back(push(i, 2 * i, 3 * i));
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    desk.silent(100ms);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
