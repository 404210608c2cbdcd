// Falcons that a dead process left: zero torque for each as soon as it is free.
#include <nlohmann/json.hpp>

#include "haptic_client/device/falcon.h"
#include "tests/emulation/falcon.h"
#include "tests/support/catch.h"
#include "tests/support/emulated_port.h"

using namespace palpate;
using namespace palpate::client;

namespace {

/// Another program holds it, and does not let it go.
class HeldPort : public UsbTransport {
 public:
  explicit HeldPort(int& tries) : tries_(tries) {}
  bool open(Time) noexcept override {
    ++tries_;
    return false;
  }
  void close() noexcept override {}
  void control(const UsbRequest&) noexcept override {}
  bool write(std::span<const std::byte>) noexcept override { return false; }
  std::size_t read(std::span<std::byte>) noexcept override { return 0; }
  State state() const noexcept override { return State::kClosed; }
  const char* trouble() const noexcept override { return "held"; }

 private:
  int& tries_;
};

/// Notes how often the other had been tried when bytes went here first.
class WatchedPort : public test::EmulatedPort {
 public:
  WatchedPort(emulation::UsbDevice& device, const int& tries, int& tries_before)
      : EmulatedPort(device), tries_(tries), tries_before_(tries_before) {}
  bool write(std::span<const std::byte> out) noexcept override {
    if (tries_before_ < 0) tries_before_ = tries_;
    return EmulatedPort::write(out);
  }

 private:
  const int& tries_;
  int& tries_before_;
};

/// A port of which a transfer fails when that is asked for; then it must be opened again, if it can be.
class FailingPort : public test::EmulatedPort {
 public:
  using EmulatedPort::EmulatedPort;
  void fail(bool for_good) {
    lost_ = true;
    removed_ = for_good;
  }
  bool open(Time now) noexcept override {
    if (removed_) return false;
    lost_ = false;
    return EmulatedPort::open(now);
  }
  void close() noexcept override {
    lost_ = false;
    EmulatedPort::close();
  }
  bool write(std::span<const std::byte> out) noexcept override {
    return state() == State::kIdle && EmulatedPort::write(out);
  }
  State state() const noexcept override { return lost_ ? State::kLost : EmulatedPort::state(); }
  const char* trouble() const noexcept override { return lost_ ? "a transfer failed" : ""; }

 private:
  bool lost_ = false, removed_ = false;
};

/// A port whose first transfers stay on the way for so many looks at it.
class SlowPort : public test::EmulatedPort {
 public:
  using EmulatedPort::EmulatedPort;
  void hold_up(int polls) { polls_ = polls; }
  State state() const noexcept override {
    return polls_ > 0 && polls_-- > 0 ? State::kBusy : EmulatedPort::state();
  }

 private:
  mutable int polls_ = 0;
};

nlohmann::json state_of(emulation::Falcon& falcon) {
  return nlohmann::json::parse(falcon.state(0));
}

/// As a process leaves a Falcon that dies while it pushes.
void leave_pushing(emulation::Falcon& falcon) {
  test::EmulatedPort dead(falcon);
  dead.open(Time::zero());
  FalconMachine::normal_mode(dead);
  dead.write(encode_falcon({.torque = {500, -600, 700}}));
  REQUIRE(state_of(falcon)["dac"] != nlohmann::json({0, 0, 0}));
}

/// A homed Falcon under force.
template <class Port>
struct Pushing {
  explicit Pushing(emulation::Falcon& falcon)
      : owned(std::make_unique<Port>(falcon)), port(*owned), device(std::move(owned), {}, 10000, 1) {
    bool valid = false;
    for (int tick = 0; tick < 5000 && !valid; ++tick) {
      port.advance(t += std::chrono::milliseconds(1));
      valid = device.read(t).valid;
      device.write(Vec3::Zero());
    }
    REQUIRE(valid);
    device.write({0, 2, 0});
    REQUIRE(state_of(falcon)["dac"] != nlohmann::json({0, 0, 0}));
  }
  std::unique_ptr<Port> owned;
  Port& port;
  Falcon device;
  Time t = Time::zero();
};

}  // namespace

TEST_CASE("a Falcon that another program holds does not keep the dead client's waiting for its zero") {
  emulation::Falcon falcon({.loaded = true, .homed = true});
  leave_pushing(falcon);
  int tries = 0, tries_before = -1;
  std::vector<std::unique_ptr<UsbTransport>> ports;
  ports.push_back(std::make_unique<HeldPort>(tries));
  ports.push_back(std::make_unique<WatchedPort>(falcon, tries, tries_before));
  const Silenced silenced = silence_falcons(std::move(ports));
  CHECK(silenced.falcons == 1);
  CHECK(silenced.held == 1);
  CHECK(state_of(falcon)["dac"] == nlohmann::json({0, 0, 0}));
  CHECK(tries_before == 1);
  CHECK(tries > 50);  // the other was waited for
}

TEST_CASE("a Falcon that comes back while another has had its zero gets one, too") {
  emulation::Falcon first({.loaded = true, .homed = true}), second({.loaded = true, .homed = true});
  leave_pushing(first);
  leave_pushing(second);
  int polls = 0;
  const Silenced silenced = silence_falcons({}, [&](UsbPorts& ports) {
    ++polls;
    if (polls == 1) ports.push_back(std::make_unique<test::EmulatedPort>(first));
    if (polls == 4) {
      CHECK(ports.empty());
      CHECK(state_of(first)["dac"] == nlohmann::json({0, 0, 0}));
      ports.push_back(std::make_unique<test::EmulatedPort>(second));
    }
  });
  CHECK(silenced.falcons == 2);
  CHECK(silenced.held == 0);
  CHECK(state_of(second)["dac"] == nlohmann::json({0, 0, 0}));
}

TEST_CASE("a Falcon that is let go of gets its zero, also when its last force is held up for a second") {
  emulation::Falcon falcon({.loaded = true, .homed = true});
  Pushing<SlowPort> held(falcon);
  held.port.hold_up(400);  // looked at each 2 ms: beyond what one wait for it bears
  CHECK(held.device.stop());
  CHECK(state_of(falcon)["dac"] == nlohmann::json({0, 0, 0}));
}

TEST_CASE("a Falcon of which a transfer failed under force gets its zero at the end all the same") {
  const bool looked_at = GENERATE(false, true);  // whether the driver has seen it, and waits to try again
  emulation::Falcon falcon({.loaded = true, .homed = true});
  Pushing<FailingPort> held(falcon);
  held.port.fail(false);
  if (looked_at) held.device.read(held.t += std::chrono::milliseconds(1));
  REQUIRE(state_of(falcon)["dac"] != nlohmann::json({0, 0, 0}));
  CHECK(held.device.stop());
  CHECK(state_of(falcon)["dac"] == nlohmann::json({0, 0, 0}));
}

TEST_CASE("a Falcon that cannot be reached any more is said to push where it may, and only there") {
  const bool pushes = GENERATE(true, false);
  emulation::Falcon falcon({.loaded = true, .homed = true});
  Pushing<FailingPort> held(falcon);
  for (int tick = 0; tick < 3 && !pushes; ++tick) {
    held.port.advance(held.t += std::chrono::milliseconds(1));
    held.device.read(held.t);
    held.device.write(Vec3::Zero());
  }
  held.port.fail(true);
  held.device.read(held.t += std::chrono::milliseconds(1));
  CHECK(held.device.stop() == !pushes);
}
