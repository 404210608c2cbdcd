#include "tests/emulation/delta_mechanism.h"

#include <utility>

#include "tests/emulation/falcon_mechanics.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate::emulation;
using palpate::test::Random;

namespace {

Vec draw(Random& random) {
  return {random.between(-0.04, 0.04), random.between(-0.04, 0.04), random.between(0.085, 0.155)};
}

}  // namespace

TEST_CASE("delta mechanism: the published counts on the axis") {
  const std::pair<int, double> table[] = {{-1463, 0.075}, {-990, 0.090}, {-516, 0.110}, {-200, 0.125},
                                          {0, 0.1346},    {336, 0.150},  {872, 0.170},  {1056, 0.175}};
  DeltaMechanism mechanism;
  for (const auto& [counts, z] : table) {
    CAPTURE(z);
    REQUIRE(mechanism.move_to({0, 0, z}));
    for (int leg = 0; leg < 3; ++leg) CHECK(counts_of(mechanism.thigh(leg)) == Approx(counts).margin(1.0));
  }
}

TEST_CASE("delta mechanism: the links meet everywhere in the workspace, whatever the way there") {
  Random random(1);
  DeltaMechanism wandering;
  for (int i = 0; i < 500; ++i) {
    const Vec p = draw(random);
    REQUIRE(wandering.move_to(p));
    CHECK(wandering.residual() < 1e-12);
    DeltaMechanism fresh;
    REQUIRE(fresh.move_to(p));
    for (int leg = 0; leg < 3; ++leg) CHECK(fresh.thigh(leg) == Approx(wandering.thigh(leg)).margin(1e-9));
  }
}

TEST_CASE("delta mechanism: turned by a third of a turn, the legs swap") {
  DeltaMechanism at_tool, turned;
  const double c = -0.5, s = std::sqrt(3) / 2;  // 120 degrees: right becomes top, top left, left right
  REQUIRE(at_tool.move_to({0.02, -0.01, 0.12}));
  REQUIRE(turned.move_to({c * 0.02 + s * 0.01, s * 0.02 - c * 0.01, 0.12}));
  CHECK(turned.thigh(0) == Approx(at_tool.thigh(1)));
  CHECK(turned.thigh(1) == Approx(at_tool.thigh(2)));
  CHECK(turned.thigh(2) == Approx(at_tool.thigh(0)));
}

TEST_CASE("delta mechanism: the Jacobian is the change of the angles, and its force does their work") {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    DeltaMechanism mechanism;
    const Vec p = draw(random), step{random.between(-1e-5, 1e-5), random.between(-1e-5, 1e-5), 1e-5};
    const std::array<double, 3> torque{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    REQUIRE(mechanism.move_to(p));
    const auto jacobian = mechanism.jacobian();
    double work = 0;
    for (std::size_t leg = 0; leg < 3; ++leg) {
      REQUIRE(mechanism.move_to(p + 0.5 * step));
      const double ahead = mechanism.legs()[leg].thigh;
      REQUIRE(mechanism.move_to(p - 0.5 * step));
      const double turned = ahead - mechanism.legs()[leg].thigh;
      CHECK(dot(jacobian[leg], step) == Approx(turned).epsilon(1e-4).margin(1e-9));
      work += torque[leg] * turned;
    }
    CHECK(dot(DeltaMechanism::force(jacobian, torque), step) == Approx(work).epsilon(1e-4).margin(1e-9));
  }
}

TEST_CASE("delta mechanism: out of reach it says so and stays") {
  DeltaMechanism mechanism;
  REQUIRE(mechanism.move_to({0.01, 0.02, 0.12}));
  for (const Vec& far : {Vec{0, 0, 0.25}, Vec{0.2, 0, 0.1}, Vec{0, -0.3, 0.1}}) {
    CHECK_FALSE(mechanism.move_to(far));
    CHECK(mechanism.position().y == 0.02);
    CHECK(mechanism.residual() < 1e-12);
  }
}
