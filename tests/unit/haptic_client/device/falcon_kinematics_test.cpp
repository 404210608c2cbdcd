#include "haptic_client/device/falcon_kinematics.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;

namespace {

/// Places a hand gets to: 80 mm around the middle.
Vec3 place(test::Random& random) {
  return falcon::kCentre + Vec3(0, 0, 0.015) + random.vector(0.04);
}

}  // namespace

TEST_CASE("Falcon: on the axis, the counts that others measured") {
  // Height of the grip (mm) where all three encoders show a count: figures of a public study of the device.
  const double figures[][2] = {{-1463, 75}, {-990, 90}, {-516, 110}, {-200, 125},
                               {0, 134.6},  {336, 150}, {872, 170},  {1056, 175}};
  for (const auto& [counts, height] : figures) {
    CAPTURE(counts);
    const double angle = falcon::angle_of(static_cast<int>(counts));
    const auto p = falcon::grip_position({angle, angle, angle}, falcon::kCentre);
    REQUIRE(p);
    CHECK(1e3 * (*p)[2] == Approx(height).margin(0.1));
    CHECK(p->head<2>().norm() < 1e-9);
  }
}

TEST_CASE("Falcon: angle of a count") {
  const double degree = 3.14159265358979323846 / 180;
  CHECK(falcon::angle_of(0) == Approx(35 * degree));
  CHECK((falcon::angle_of(1000) - falcon::angle_of(0)) / degree == Approx(36.4347).epsilon(1e-5));
}

TEST_CASE("Falcon: position to angles and back, to 1e-12 rad, from afar and from a tick ago") {
  test::Random random(41);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = place(random);
    const auto angles = falcon::leg_angles(p);
    REQUIRE(angles);
    for (const Vec3& guess : {falcon::kCentre, Vec3(p + random.vector(0.001))}) {
      const auto found = falcon::grip_position(*angles, guess);
      REQUIRE(found);
      CHECK((*found - p).norm() < 1e-11);
      CHECK((*falcon::leg_angles(*found) - *angles).cwiseAbs().maxCoeff() <= 1e-12);
    }
  }
}

TEST_CASE("Falcon: the links have their lengths") {
  // Independent of the formulas: knee and grip from the angles, in three dimensions; the shin must be 102.5
  // mm long between its two hinges, which the parallelogram keeps parallel.
  test::Random random(42);
  const double azimuth[] = {105, -15, -135};
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = place(random);
    const Vec3 angles = *falcon::leg_angles(p);
    for (int leg = 0; leg < 3; ++leg) {
      const double phi = azimuth[leg] * 3.14159265358979323846 / 180, t = angles[leg];
      const Vec3 out(std::cos(phi), std::sin(phi), 0), aside(-std::sin(phi), std::cos(phi), 0), up(0, 0, 1);
      const Vec3 knee = (0.040 + 0.060 * std::cos(t)) * out + 0.060 * std::sin(t) * up + (-0.02309) * aside;
      const Vec3 grip_hinge = p + 0.01443 * out - 0.025 * aside;  // c outwards, f sideways
      // In the plane of the leg the small hinges d and e lie in line with the shin's projection.
      const Vec3 way = grip_hinge - knee;
      const double sideways = way.dot(aside), in_plane = (way - sideways * aside).norm();
      CHECK(std::hypot(in_plane - 2 * 0.01125, sideways) == Approx(0.1025).margin(1e-12));
    }
  }
}

TEST_CASE("Falcon: the Jacobian agrees with finite differences") {
  test::Random random(43);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = place(random);
    const Mat3 j = *falcon::jacobian(p);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 h = kStep * Vec3::Unit(axis);
      const Vec3 slope = (*falcon::leg_angles(p + h) - *falcon::leg_angles(p - h)) / (2 * kStep);
      CHECK((j.col(axis) - slope).norm() < 1e-6 * j.norm());
    }
  }
}

TEST_CASE("Falcon: torques give the force by virtual work, and clipping keeps the direction") {
  test::Random random(44);
  constexpr double kK = 10000;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = place(random), f = random.vector(2), dac = falcon::motor_commands(f, p, kK);
    const Mat3 j = *falcon::jacobian(p);
    const Vec3 rendered = j.transpose() * (-dac / kK);  // J^T tau
    CHECK((rendered - f).norm() < 1e-9);
    const Vec3 clipped = falcon::motor_commands(100 * f, p, kK);
    CHECK(clipped.cwiseAbs().maxCoeff() <= 4096 * (1 + 1e-12));
    const Vec3 weaker = j.transpose() * (-clipped / kK);
    CHECK(weaker.normalized().dot(f.normalized()) == Approx(1).epsilon(1e-12));
  }
  // The worst direction before clipping, with K = 10000: figures of the same study.
  const Vec3 dac = falcon::motor_commands({0, 0, 1}, {0, 0, 0.125}, kK);
  CHECK(dac[0] == Approx(dac[1]));
  CHECK(dac[1] == Approx(dac[2]));
}

TEST_CASE("Falcon: places and angles that cannot be give nothing") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3& p : {Vec3(0.5, 0, 0), Vec3(0, 0, 0.4), Vec3(kNan, 0, 0.1), Vec3(1e30, 0, 0)}) {
    CHECK_FALSE(falcon::leg_angles(p));
    CHECK_FALSE(falcon::jacobian(p));
    CHECK(falcon::motor_commands({0, 0, 1}, p, 1e4) == Vec3::Zero());
  }
  CHECK_FALSE(falcon::grip_position({kNan, 0, 0}, falcon::kCentre));
  CHECK_FALSE(falcon::grip_position({-3, 3, 1}, falcon::kCentre));
  CHECK(falcon::motor_commands({kNan, 0, 0}, falcon::kCentre, 1e4) == Vec3::Zero());
}
