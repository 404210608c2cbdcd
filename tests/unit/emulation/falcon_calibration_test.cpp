// The calibration of the torque constant against the emulated Falcon: driver, state machine and limiter in
// virtual time.
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "haptic_client/calibration/calibration.h"
#include "haptic_client/device/falcon.h"
#include "tests/emulation/falcon.h"
#include "tests/support/catch.h"
#include "tests/support/emulated_port.h"

using namespace palpate;
using namespace palpate::client;
using Stage = CalibrationStage;
using Trouble = CalibrationTrouble;

namespace {

constexpr double kAssumed = 2300;
constexpr const char* kLetGo = "hand stiffness 0 damping 0";

/// An emulated Falcon on a table, and somebody who does what the calibration asks for.
class Table {
 public:
  Table(const emulation::FalconMechanics::Settings& mechanics, double mass)
      : emulated_({.loaded = true, .homed = true, .mechanics = mechanics}),
        falcon_(own_port(), {}, kAssumed),
        calibration({.mass = mass, .assumed = kAssumed}) {
    command("hand place 0.02 -0.02 0.10");
    on_entering[Stage::kCentre] = kLetGo;
    on_entering[Stage::kHang] = "hand weight " + std::to_string(mass);
  }

  void command(const std::string& line) {
    emulation::Words words;
    std::istringstream in(line);
    for (std::string word; in >> word;) words.push_back(word);
    const std::string verb = words.front();
    words.erase(words.begin());
    emulated_.command(verb, words, 0);
  }
  nlohmann::json state() { return nlohmann::json::parse(emulated_.state(0)); }

  /// Until it has ended, or for so long.
  void run(double most_seconds = 400) {
    for (const double end = seconds + most_seconds; !calibration.ended() && seconds < end;) {
      const Time now = from_seconds(1 + (seconds += 1e-3));
      port_->advance(now);
      const Stage before = calibration.progress().stage;
      const Vec3 f_D = calibration.tick(falcon_.read(now));
      falcon_.write(f_D);
      largest_force = std::max(largest_force, f_D.norm());
      const CalibrationProgress progress = calibration.progress();
      was_held = was_held || progress.held;
      if (progress.stage == before || !on_entering.contains(progress.stage)) continue;
      command(on_entering[progress.stage]);
    }
  }
  double error(double torque_constant) const { return calibration.torque_constant() / torque_constant - 1; }

 private:
  std::unique_ptr<test::EmulatedPort> own_port() {
    auto port = std::make_unique<test::EmulatedPort>(emulated_);
    port_ = port.get();
    return port;
  }
  emulation::Falcon emulated_;
  test::EmulatedPort* port_ = nullptr;
  Falcon falcon_;

 public:
  Calibration calibration;
  std::map<Stage, std::string> on_entering;  // a command
  double seconds = 0, largest_force = 0;
  bool was_held = false;
};

}  // namespace

TEST_CASE("calibration: finds torque constants of 2300 to 10000 within 0.2 %, whatever the friction") {
  struct Case {
    double torque_constant, mass;
  };
  for (const auto& [torque_constant, mass] :
       {Case{2300, 0.05}, Case{2300, 0.2}, Case{2300, 0.5}, Case{4000, 0.1}, Case{4000, 0.2},
        Case{10000, 0.05}, Case{10000, 0.1}}) {
    for (const double friction : {1, 5}) {
      for (const double grip : {0.1, 0.3}) {
        CAPTURE(torque_constant, mass, friction, grip);
        Table table(
            {.torque_constant = torque_constant, .coulomb = friction * 1e-3, .viscous = friction * 1e-4},
            mass);
        table.command("hand mass " + std::to_string(grip));
        table.run();
        CAPTURE(table.seconds, table.error(torque_constant));
        CHECK(table.calibration.trouble() == Trouble::kNone);
        CHECK(std::abs(table.error(torque_constant)) < 0.002);
        CHECK(table.calibration.uncertainty() < 0.002);
        CHECK(table.calibration.tilt() < 0.01);
        CHECK_FALSE(table.was_held);
        const auto state = table.state();
        CHECK(state["dac"] == nlohmann::json({0, 0, 0}));
        CHECK(std::abs(state["velocity"][1].get<double>()) < 0.5);
      }
    }
  }
}

TEST_CASE("calibration: no weight is hung on: it waits a minute, says so, and lets go") {
  Table table({.torque_constant = 4000}, 0.2);
  table.on_entering.erase(Stage::kHang);
  table.run();
  CHECK(table.calibration.trouble() == Trouble::kNoWeight);
  CHECK(table.calibration.difference().norm() < 0.1);
  CHECK(table.seconds == Approx(75).margin(15));
}

TEST_CASE("calibration: much less than the weight that was named does not count as one") {
  Table table({.torque_constant = 2300}, 0.2);
  table.on_entering[Stage::kHang] = "hand weight 0.08";
  table.run();
  CHECK(table.calibration.trouble() == Trouble::kNoWeight);
  CHECK(table.calibration.difference()[1] == Approx(0.08 * 9.80665).epsilon(0.1));
}

TEST_CASE(
    "calibration: another weight than the one named would mean a constant that no device has, and is no "
    "result") {
  Table table({.torque_constant = 5000}, 0.05);
  table.on_entering[Stage::kHang] = "hand weight 0.3";
  table.run();
  CHECK(table.calibration.ended());
  CHECK(table.calibration.trouble() == Trouble::kImplausible);
  CHECK(table.calibration.torque_constant() == Approx(30000).epsilon(0.02));
  CHECK(table.state()["dac"] == nlohmann::json({0, 0, 0}));
}

TEST_CASE("calibration: a hand on the grip is noticed, and what it let go of is weighed all the same") {
  for (const char* hand : {"hand stiffness 150 damping 3", "hand stiffness 600 damping 10"}) {
    for (const double torque_constant : {2300.0, 10000.0}) {
      CAPTURE(hand, torque_constant);
      Table table({.torque_constant = torque_constant}, 0.1);
      table.command("hand target 0 0 0.11");
      table.on_entering[Stage::kCentre] = hand;
      table.run(30);
      CHECK(table.calibration.progress().stage == Stage::kWeighGrip);
      CHECK(table.was_held);
      table.command(kLetGo);
      table.run();
      CHECK(table.calibration.trouble() == Trouble::kNone);
      CHECK(std::abs(table.error(torque_constant)) < 0.01);
    }
  }
}

TEST_CASE("calibration: a hand that does not let go, here or elsewhere, ends it") {
  Table table({.torque_constant = 4000}, 0.1), away({.torque_constant = 4000}, 0.1);
  table.command("hand target 0 0 0.11");
  table.on_entering[Stage::kCentre] = "hand stiffness 300 damping 5";
  table.run();
  CHECK(table.calibration.trouble() == Trouble::kHeld);
  away.on_entering[Stage::kCentre] = "hand stiffness 800 damping 5";
  away.run();
  CHECK(away.calibration.trouble() == Trouble::kNotMoved);
}

TEST_CASE("calibration: a hand on the weight is noticed") {
  Table table({.torque_constant = 4000}, 0.1);
  table.on_entering[Stage::kWeighBoth] = "hand stiffness 200 damping 5";
  table.run();
  CHECK(table.was_held);
  CHECK(table.calibration.trouble() == Trouble::kHeld);
}

TEST_CASE("calibration: a weight that is too heavy: it says which does, and that one does") {
  Table heavy({.torque_constant = 10000}, 0.5);
  heavy.run();
  CHECK(heavy.calibration.trouble() == Trouble::kTooHeavy);
  CHECK(heavy.largest_force <= 8 + 1e-9);
  const double lighter = heavy.calibration.largest_mass();
  CHECK(lighter == Approx(0.9 * 8 * 0.23 / 9.80665).epsilon(0.05));
  Table again({.torque_constant = 10000}, lighter);
  again.run();
  CHECK(again.calibration.trouble() == Trouble::kNone);
  CHECK(std::abs(again.error(10000)) < 0.01);
}

TEST_CASE("calibration: a moment without positions is got over, wherever it comes") {
  for (const Stage stage : {Stage::kCentre, Stage::kWeighGrip, Stage::kHang, Stage::kWeighBoth}) {
    Table table({.torque_constant = 4000}, 0.1);
    for (int moments = 0; !table.calibration.ended();) {
      table.run(3e-3);
      if (table.calibration.progress().stage != stage || ++moments != 300) continue;  // a second into it
      table.command("fault mute");
      table.run(0.3);
      CHECK(table.calibration.progress().newton == 0);
      table.command("fault mute 0");
    }
    CHECK(table.calibration.trouble() == Trouble::kNone);
    CHECK(std::abs(table.error(4000)) < 0.01);
  }
}

TEST_CASE("calibration: without mains, unplugged, never homed: no force, and it says so") {
  Table dark({}, 0.1);
  dark.command("power off");
  dark.run();
  CHECK(dark.calibration.trouble() == Trouble::kNotMoved);
  Table lost({}, 0.1);
  lost.on_entering[Stage::kWeighGrip] = "fault mute";
  lost.run();
  CHECK(lost.calibration.trouble() == Trouble::kLost);
  CHECK(lost.calibration.ended());
  Calibration calibration({});
  for (int i = 0; i < 121000; ++i)
    if (calibration.tick({.t = from_seconds(1e-3 * i), .valid = false}) != Vec3(0, 0, 0)) FAIL("a force");
  CHECK(calibration.trouble() == Trouble::kNotHomed);
}
