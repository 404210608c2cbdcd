// A Falcon: a packet to the emulated device and back through libusb and the shim, and all that a tick of the
// client does besides.
#include <sstream>

#include "common/text.h"
#include "haptic_client/device/falcon.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "tests/bench/bench.h"
#include "tests/bench/palpation.h"
#include "tests/emulation/emulator.h"

namespace palpate::bench {
using namespace client;

namespace {

constexpr int kTurn = 512;  // ticks

/// A homed Falcon that answers at once, each tick from another place; it costs next to nothing.
class FakePort : public UsbTransport {
 public:
  FakePort() {
    for (int k = 0; k < kTurn; ++k) {
      const double phi = 2 * std::numbers::pi * k / kTurn;
      FalconCommand place{.homing = false};  // both ways have the same bytes, but for the flags
      for (std::size_t leg = 0; leg < 3; ++leg)
        place.torque[leg] = static_cast<std::int16_t>(-500 + 200 * std::sin(phi + static_cast<double>(leg)));
      const auto bytes = encode_falcon(place);
      auto& reply = replies_[static_cast<std::size_t>(k)];
      std::ranges::copy(bytes, reply.begin() + kFtdiStatus);
      reply[kFtdiStatus + 13] = std::byte{0x41 + 0x70};  // homed
    }
  }
  bool open(Time) noexcept override { return true; }
  void close() noexcept override {}
  void control(const UsbRequest&) noexcept override {}
  bool write(std::span<const std::byte> bytes) noexcept override {
    for (const std::byte byte : bytes) sum_ = 31 * sum_ + std::to_integer<std::uint64_t>(byte);
    ++due_;
    return true;
  }
  std::size_t read(std::span<std::byte> out) noexcept override {
    if (due_ == 0) return 0;
    --due_;
    const auto& reply = replies_[next_++ % kTurn];
    std::ranges::copy(reply, out.begin());
    return reply.size();
  }
  State state() const noexcept override { return State::kIdle; }
  const char* trouble() const noexcept override { return ""; }
  /// Of all bytes that were written.
  std::uint64_t sum() const { return sum_; }

 private:
  std::array<std::array<std::byte, kFtdiStatus + kFalconPacket>, kTurn> replies_{};
  std::size_t next_ = 0;
  int due_ = 0;
  std::uint64_t sum_ = 0;
};

/// Bytes in, place, force of the law for it, limits, motor commands, bytes out.
void run_tick(benchmark::State& state, const std::string& law) {
  auto own = std::make_unique<FakePort>();
  const FakePort& port = *own;
  Falcon falcon(std::move(own), {}, 10000);
  Palpation hand;  // its samples; the place is the Falcon's
  Pipeline pipeline(find_row(extrapolators(), law, "method", "bench").make(), {}, {});
  time_calls(state, 8 * kTurn, [&] {
    hand.next();
    const DeviceReading reading = falcon.read(Time{hand.tool().t_ns});
    falcon.write(pipeline.tick(reading, hand.arrived()).f_D);
    return port.sum();
  });
  if (pipeline.stats().max_newton < 0.1 || pipeline.limiter().fault() != Fault::kNone)
    state.SkipWithError("no force came out");
}

/// The number behind a word.
double number_after(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  if (at == std::string::npos) fail_at_run_time("usb_smoke: {}", text);
  return std::stod(text.substr(at + word.size()));
}

/// `trips` in a program of its own. The time is the middle one's.
void run_round_trips(benchmark::State& state, const std::string& clock, int trips) {
  const test::Emulator usb({"falcon:2-1"}, {"--loaded", "--homed", "--clock", clock});
  double p50 = 0, p99 = 0, rate = 0;
  for (auto _ : state) {
    const auto program = usb.start("usb_smoke", {"round_trips", std::to_string(trips)});
    program->wait();
    const std::string said = program->output();
    p50 = number_after(said, "p50_us ");
    p99 = number_after(said, "p99_us ");
    rate = number_after(said, "round_trips_per_second ");
    state.SetIterationTime(p50 * 1e-6);
  }
  state.counters["p50"] = p50;
  state.counters["p99"] = p99;
  state.counters["rate"] = rate;
}

}  // namespace

void add_falcon_rows() {
  for (const std::string law : {"constant", "learned_stiffness"})
    add("tick_falcon/besides_usb/" + law, [=](benchmark::State& state) { run_tick(state, law); });
  add("usb_round_trip/virtual_clock",
      [](benchmark::State& state) { run_round_trips(state, "virtual", 5000); })
      ->UseManualTime()
      ->Iterations(1);
  add("usb_round_trip/wall_clock", [](benchmark::State& state) { run_round_trips(state, "wall", 500); })
      ->UseManualTime()
      ->Iterations(1);
}

}  // namespace palpate::bench
