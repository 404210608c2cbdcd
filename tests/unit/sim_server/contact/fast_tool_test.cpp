// Tools that go far in one step do not pass through the surface.
#include "sim_server/mesh/shapes.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDt = 0.03, kRadius = 0.005;

Simulation organ(const Tool& tool) {
  Scene scene = test::wide_block_scene(1, kRadius);
  scene.tools[0].shape = tool;
  return Simulation(scene, test::wide_block());
}

const std::array<Tool, 4> kTools{Tool{kRadius}, Tool{kRadius, 0.3}, Tool{.radius = kRadius, .length = 0.015},
                                 Tool{.radius = kRadius, .friction = 0.3, .length = 0.015}};
/// A capsule's axis lies along x.
const Quat kLevel = test::turn_between(Vec3::UnitZ(), Vec3::UnitX());

}  // namespace

TEST_CASE("20 mm or 100 mm down in one step: the surface is pressed, not passed") {
  for (const Tool& tool : kTools) {
    for (const double from : {0.0152, 0.0952}) {
      CAPTURE(tool.length, tool.friction, from);
      Simulation fast = organ(tool), slow = organ(tool);
      REQUIRE(fast.step({Vec3(-0.006, from, 0.0013), kLevel}, kDt).contacts == 0);
      const Vec3 end(-0.006, -0.0048, 0.0013);  // 9.8 mm deep
      const ToolForce force = fast.step({end, kLevel}, kDt);
      CHECK_FALSE(force.flagged);
      for (double y = from; y > end[1]; y -= 0.0005) slow.step({Vec3(end[0], y, end[2]), kLevel}, kDt);
      const ToolForce expected = slow.step({end, kLevel}, kDt);
      CHECK(force.force[1] > 0.1);
      CHECK((force.force - expected.force).norm() < (tool.friction > 0 ? 0.1 : 1e-3) * expected.force.norm());
    }
  }
}

TEST_CASE(
    "100 mm across the organ in one step: it ends in a finite answer, and lifting it frees the tissue") {
  for (const Tool& tool : kTools) {
    CAPTURE(tool.length, tool.friction);
    Simulation fast = organ(tool);
    const std::uint64_t rest = fast.state_hash();
    fast.step({Vec3(-0.0602, -0.004, 0), kLevel}, kDt);
    const ToolForce force = fast.step({Vec3(0.0398, -0.004, 0), kLevel}, kDt);
    CHECK(force.force.allFinite());
    CHECK((force.contacts > 0 || force.flagged));  // it is in the tissue
    test::lift_tools(fast);
    fast.step({Vec3(0, 0.2, 0), kLevel}, kDt);
    CHECK(fast.state_hash() == rest);
  }
}

TEST_CASE("a capsule that turns by a right angle in one step presses the surface and does not cut it") {
  Simulation fast = organ({.radius = kRadius, .length = 0.02}),
             slow = organ({.radius = kRadius, .length = 0.02});
  const Vec3 p(0, 0.018, 0.0013);
  const auto turned = [](double angle) {
    return Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ())) * test::turn_between(Vec3::UnitZ(), Vec3::UnitX());
  };
  REQUIRE(fast.step({p, turned(0)}, kDt).contacts == 0);
  const ToolForce force = fast.step({p, turned(-1.5)}, kDt);
  for (double angle = 0; angle > -1.5; angle -= 0.02) slow.step({p, turned(angle)}, kDt);
  const ToolForce expected = slow.step({p, turned(-1.5)}, kDt);
  CHECK_FALSE(force.flagged);
  CHECK(force.force[1] > 0.05);
  CHECK((force.force - expected.force).norm() < 0.02 * expected.force.norm());
}

TEST_CASE("a capsule whose turn takes more than a step has says so, and gets there in the next ones") {
  Simulation fast = organ({.radius = kRadius, .length = 0.03}),
             slow = organ({.radius = kRadius, .length = 0.03});
  const auto turned = [](double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ())) * kLevel; };
  const Vec3 p(0, 0.011, 0.0013);  // in the end 14 mm deep
  fast.step({p, turned(0)}, kDt);
  slow.step({p, turned(0)}, kDt);
  ToolForce force = fast.step({p, turned(-1.5)}, kDt), expected;
  CHECK(force.flagged);  // it has not arrived, though its tip has not moved
  for (int i = 0; i < 5; ++i) force = fast.step({p, turned(-1.5)}, kDt);
  for (int i = 1; i <= 15; ++i) expected = slow.step({p, turned(-0.1 * i)}, kDt);
  CHECK_FALSE(force.flagged);
  CHECK((force.force - expected.force).norm() < 1e-3 * expected.force.norm());
}

TEST_CASE("a tool that appears with its axis through the organ has come in through the nearest surface") {
  // Along z through the block, both ends outside; also nearer to its bottom, which is held to something.
  for (const double y : {-0.002, -0.0163}) {
    Simulation capsule = organ({.radius = kRadius, .length = 0.06}),
               came = organ({.radius = kRadius, .length = 0.06});
    const Vec3 through(0.0013, y, -0.03);
    const ToolForce appeared = capsule.step({through, Quat::Identity()}, kDt);
    came.step({through + Vec3(0, 0.03, 0), Quat::Identity()}, kDt);
    const ToolForce expected = came.step({through, Quat::Identity()}, kDt);
    CAPTURE(y, appeared.force.transpose(), expected.force.transpose());
    double most = 0, apart = 0;
    for (std::size_t v = 0; v < capsule.rest().size(); ++v) {
      most = std::max(most, (capsule.positions()[v] - capsule.rest()[v]).norm());
      apart = std::max(apart, (capsule.positions()[v] - came.positions()[v]).norm());
    }
    CHECK(most > 0.004);
    CHECK(apart < 1e-3 * most);
    // The deeper one turns the sides of the block inside out: the linear law has no force for that.
    const bool has_force = y > -0.01;
    CHECK(appeared.flagged == !has_force);
    CHECK(expected.flagged == !has_force);
    CHECK(appeared.force[1] > (has_force ? 0.1 : -1e-12));
    CHECK((appeared.force - expected.force).norm() <= 1e-3 * expected.force.norm());
  }

  const Tool tool{.radius = 0.004, .trocar = Tool::Trocar{Vec3(-0.1, 0.0, 0.0013), 0.003}};
  Simulation instrument = organ(tool), pressed = organ(tool);
  const Vec3 tip(0.06, -0.004, 0.0013);
  const ToolForce at_once = instrument.step(tip, kDt);
  pressed.step(tip + Vec3(0, 0.03, 0), kDt);
  const ToolForce slowly = pressed.step(tip, kDt);
  CHECK(at_once.force[1] > 0.01);
  CHECK((at_once.force - slowly.force).norm() < 1e-3 * slowly.force.norm());
}

TEST_CASE("a tool with an axis that has left the organ far behind lets go of it") {
  const Tool tools[] = {{.radius = kRadius, .length = 0.015},
                        {.radius = 0.004, .trocar = Tool::Trocar{Vec3(-0.1, 0.05, 0.0013), 0.003}}};
  for (const Tool& tool : tools) {
    Simulation simulation = organ(tool);
    simulation.step({Vec3(0, 0.02, 0.0013), kLevel}, kDt);
    REQUIRE(simulation.step({Vec3(0, 0.002, 0.0013), kLevel}, kDt).contacts > 0);
    const ToolForce away = simulation.step({Vec3(0, 0.05, 0.0013), kLevel}, kDt);
    CHECK(away.contacts == 0);
    CHECK(away.force == Vec3::Zero());
  }
}

TEST_CASE("before a shaft touches, the nearest surface is told for all of it, as the tip has to go") {
  // Level over the block, the pivot 100 mm left of its middle; the tip is off the right edge.
  const Tool tool{.radius = 0.005, .trocar = Tool::Trocar{Vec3(-0.1, 0.004, 0.0013), 0.002}};
  Simulation simulation = organ(tool);
  const Vec3 tip(0.1, 0.004, 0.0013);
  CHECK(simulation.step(tip, kDt).contacts == 0);
  const Linearisation plane = simulation.linearise(0, tip, nullptr);
  CHECK(plane.normal_W[1] == Approx(1).epsilon(1e-6));
  // 2 mm clear all along the block; where on a parallel edge is a matter of choice: x from -40 to 40 mm.
  CHECK(plane.gap >= Approx(0.002 * 0.2 / 0.14));
  CHECK(plane.gap <= Approx(0.002 * 0.2 / 0.06));
  const Tool lying{.radius = kRadius, .length = 0.05};
  Simulation capsule = organ(lying);
  const Quat tilted = test::turn_between(Vec3::UnitZ(), Vec3(0.8, -0.6, 0));
  const Vec3 high(-0.02, 0.037, 0.0013);  // its far end is 30 mm lower: 7 mm above the top
  CHECK(capsule.step({high, tilted}, kDt).contacts == 0);
  const Linearisation below = capsule.linearise(0, high, nullptr);
  CHECK(below.gap == Approx(0.002));
  CHECK(below.normal_W[1] == Approx(1));
  CHECK(below.tangent(1, 1) < 0);
}

TEST_CASE("an instrument at a trocar: its shaft presses the edge of the organ and its tip is free") {
  // Over the left edge of the block, the tip beyond its right edge and above it.
  Simulation simulation = organ({.radius = 0.004, .trocar = Tool::Trocar{Vec3(-0.1, 0.05, 0.0013), 0.003}});
  REQUIRE(simulation.step(Vec3(0.05, 0.05, 0.0013), kDt).contacts == 0);
  ToolForce force;
  for (double y = 0.05; y > -0.04; y -= 0.01) force = simulation.step(Vec3(0.05, y, 0.0013), kDt);
  CHECK(force.contacts > 0);
  CHECK_FALSE(force.flagged);
  CHECK(force.force[1] > 0);
  // Nothing pulls along a shaft without friction but what bends with it.
  const Vec3 axis = (Vec3(0.05, -0.04, 0.0013) - Vec3(-0.1, 0.05, 0.0013)).normalized();
  CHECK(std::abs(force.force.dot(axis)) < 0.1 * force.force.norm());
}
