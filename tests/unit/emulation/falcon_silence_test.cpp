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

/// A port whose first transfers stay on the way for so many looks at it.
class SlowPort : public test::EmulatedPort {
 public:
  using EmulatedPort::EmulatedPort;
  void hold_up(int looks) { looks_ = looks; }
  State state() const noexcept override {
    return looks_ > 0 && looks_-- > 0 ? State::kBusy : EmulatedPort::state();
  }

 private:
  mutable int looks_ = 0;
};

nlohmann::json state_of(emulation::Falcon& falcon) {
  return nlohmann::json::parse(falcon.state(0));
}

}  // namespace

TEST_CASE("a Falcon that another program holds does not keep the dead client's waiting for its zero") {
  emulation::Falcon falcon({.loaded = true, .homed = true});
  {
    test::EmulatedPort dead(falcon);
    dead.open(Time::zero());
    FalconMachine::normal_mode(dead);
    dead.write(encode_falcon({.torque = {500, -600, 700}}));
  }
  REQUIRE(state_of(falcon)["dac"] != nlohmann::json({0, 0, 0}));
  int tries = 0, tries_before = -1;
  std::vector<std::unique_ptr<UsbTransport>> ports;
  ports.push_back(std::make_unique<HeldPort>(tries));
  ports.push_back(std::make_unique<WatchedPort>(falcon, tries, tries_before));
  CHECK(silence_falcons(ports) == 1);
  CHECK(state_of(falcon)["dac"] == nlohmann::json({0, 0, 0}));
  CHECK(tries_before == 1);
  CHECK(tries > 50);  // the other was waited for
}

TEST_CASE("a Falcon that is let go of gets its zero, also when its last force is held up for a second") {
  emulation::Falcon falcon({.loaded = true, .homed = true});
  auto owned = std::make_unique<SlowPort>(falcon);
  SlowPort& port = *owned;
  Falcon device(std::move(owned), {}, 10000, 1);
  Time t = Time::zero();
  bool valid = false;
  for (int tick = 0; tick < 5000 && !valid; ++tick) {
    port.advance(t += std::chrono::milliseconds(1));
    valid = device.read(t).valid;
    device.write(Vec3::Zero());
  }
  REQUIRE(valid);
  device.write({0, 2, 0});
  REQUIRE(state_of(falcon)["dac"] != nlohmann::json({0, 0, 0}));
  port.hold_up(400);  // looked at each 2 ms: beyond what one wait for it bears
  device.stop();
  CHECK(state_of(falcon)["dac"] == nlohmann::json({0, 0, 0}));
}
