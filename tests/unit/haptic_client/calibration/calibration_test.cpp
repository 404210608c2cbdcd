// The calibration on a mass that anything may pull at.
#include "haptic_client/calibration/calibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;

namespace {

/// A mass on which dry friction pulls, with a weight from the moment it is asked for; a true newton is
/// `ratio` newtons as assumed.
struct Mass {
  Vec3 p{0.01, 0, 0.1}, v = Vec3::Zero();
  Vec3 gravity{0, -9.80665, 0};  // m/s2
  double grip = 0.1, own_weight = 0.05, friction = 0, ratio = 1;
};

/// Until it has ended; the largest |force|.
double run(Calibration& calibration, Mass mass, double weight) {
  constexpr double kTick = 1e-3, kStep = 1e-5;
  double largest = 0;
  bool hangs = false;
  for (double t = 1; !calibration.ended() && t < 400; t += kTick) {
    hangs = hangs || calibration.progress().stage == CalibrationStage::kHang;
    const Vec3 f_D = calibration.tick({.t = from_seconds(t), .p_D = mass.p}) / mass.ratio;
    largest = std::max(largest, f_D.norm());
    const double pulled = mass.own_weight + (hangs ? weight : 0), moved = mass.grip + (hangs ? weight : 0);
    for (double s = 0; s < kTick; s += kStep) {
      const Vec3 pull = f_D + pulled * mass.gravity, dry = mass.v + kStep / moved * pull;
      const double brake = kStep / moved * mass.friction;  // of the speed it would have without
      mass.v = dry.norm() <= brake ? Vec3(Vec3::Zero()) : Vec3((1 - brake / dry.norm()) * dry);
      mass.p += kStep * mass.v;
      for (int i = 0; i < 3; ++i) mass.p[i] = std::clamp(mass.p[i], -0.07, 0.18);
    }
  }
  return largest;
}

}  // namespace

TEST_CASE(
    "calibration: dry friction of up to a fifth of the weight cancels, and so does the weight of the grip") {
  for (const double ratio : {1.0, 2.0, 4.0}) {
    for (const double friction : {0.0, 0.05, 0.2}) {
      CAPTURE(ratio, friction);
      Calibration calibration({.mass = 0.1});
      run(calibration, {.friction = friction, .ratio = ratio}, 0.1);
      CHECK(calibration.trouble() == CalibrationTrouble::kNone);
      CHECK(calibration.torque_constant() == Approx(2300 * ratio).epsilon(0.02));
    }
  }
}

TEST_CASE(
    "calibration: a device that does not stand upright shows as a tilt, and does not spoil the result") {
  for (const double degrees : {3.0, 20.0}) {
    const double tilt = degrees * std::numbers::pi / 180;
    Calibration calibration({.mass = 0.2});
    const Vec3 gravity = 9.80665 * Vec3(0, -std::cos(tilt), std::sin(tilt));
    run(calibration, {.gravity = gravity}, 0.2);
    CHECK(calibration.trouble() == CalibrationTrouble::kNone);
    CHECK(calibration.tilt() == Approx(tilt).epsilon(0.02));
    CHECK(calibration.torque_constant() == Approx(2300).epsilon(0.01));
  }
}

TEST_CASE("calibration: no force before there is a position, none while one is lost or is not finite") {
  const DeviceReading good{.p_D = {0, 0, 0.1}};
  for (const DeviceReading& bad :
       {DeviceReading{.p_D = good.p_D, .valid = false}, DeviceReading{.p_D = {0, std::nan(""), 0}}}) {
    Calibration calibration({});
    DeviceReading reading = bad;
    const auto tick = [&](const DeviceReading& now) {
      const Time t = reading.t + std::chrono::milliseconds(1);
      reading = now;
      reading.t = t;
      return calibration.tick(reading);
    };
    for (int i = 0; i < 100; ++i) CHECK(tick(bad) == Vec3(0, 0, 0));
    Vec3 f_D;
    for (int i = 0; i < 1000; ++i) f_D = tick(good);
    CHECK(f_D[2] > 1);  // towards the middle
    CHECK(tick(bad) == Vec3(0, 0, 0));
    CHECK(tick(good).norm() < 0.01);  // from none again
    for (int i = 0; i < 1000; ++i) f_D = tick(good);
    CHECK(f_D[2] > 1);
    for (int i = 0; i < 1100; ++i) CHECK(tick(bad) == Vec3(0, 0, 0));
    CHECK(calibration.ended());
    CHECK(calibration.trouble() == CalibrationTrouble::kLost);
    CHECK(tick(good) == Vec3(0, 0, 0));
  }
}

TEST_CASE("grip holder: against a grip that does not move the force grows slowly, up to its limit") {
  GripHolder holder(8);
  const Vec3 p_D(0, 0, 0.1), goal_D(0, 0.06, 0.1);
  holder.begin(p_D);
  const auto after = [&](double seconds) {
    Vec3 f_D;
    for (double t = 0; t < seconds; t += 1e-3) f_D = holder.push(p_D, goal_D, 1e-3);
    return f_D.norm();
  };
  CHECK(after(0.05) < 0.5);
  CHECK(after(0.95) < 4);
  CHECK(after(5) == Approx(8));
  CHECK_FALSE(holder.saturated());
  CHECK(after(2) == Approx(8));
  CHECK(holder.saturated());
  CHECK_FALSE(holder.at_rest());
}

TEST_CASE("calibration: the limits of the client file hold") {
  Calibration calibration({.mass = 0.3, .limits = {.max_force = 2, .max_slew = 160}});
  CHECK(run(calibration, {}, 0.3) <= 2 + 1e-12);
  CHECK(calibration.trouble() == CalibrationTrouble::kTooHeavy);
}
