// A tool in tissue that its `reach` leaves out feels nothing of it: that force is flagged, with the reason.
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;
using Catch::Matchers::WithinAbs;

namespace {

constexpr double kDt = 1.0 / 30, kRadius = 0.006;

/// A block of 60 x 40 x 60 mm whose top, y = 0, may be touched where x < -10 mm.
Simulation block(const Tool& shape = {.radius = kRadius}) {
  Scene scene = scene_of({.young_modulus = 1e4, .poisson_ratio = 0.45},
                         {Vec3(-1, -1, -1), Vec3(1, -0.0399, 1)}, kRadius);
  scene.deformation.model = "quasi_static";
  scene.tools.front().shape = shape;
  scene.tools.front().reach = Box{Vec3(-0.03, -0.001, -0.03), Vec3(-0.01, 0.001, 0.03)};
  return {scene, grid_block(lines(-0.03, 0.03, 12), lines(-0.04, 0, 8), lines(-0.03, 0.03, 12))};
}

}  // namespace

TEST_CASE("a tool beside its reach is flagged where it is in the organ, and only there") {
  Simulation simulation = block();
  const auto at = [&](double x, double y) { return simulation.step(ToolPose(Vec3(x, y, 0.002)), kDt); };
  CHECK_FALSE(at(0.015, 0.0065).flagged);  // 0.5 mm above
  const ToolForce pressed = at(0.015, 0.003);
  CHECK(pressed.flagged);
  CHECK(pressed.force.norm() == 0);
  CHECK_THAT(simulation.flagged().deepest, WithinAbs(0.003, 1e-12));
  CHECK(at(0.015, -0.01).flagged);  // its centre is in the organ, 10 mm deep
  CHECK_THAT(simulation.flagged().deepest, WithinAbs(0.016, 1e-12));
  CHECK(simulation.flagged().outside_reach == 2);
  CHECK(simulation.flagged().to_text().find("by up to 16.0 mm") != std::string::npos);
}

TEST_CASE("a tool that slides out of its reach while it presses is flagged from there on") {
  Simulation simulation = block();
  double last_good = -1;
  bool flagged_before = false;
  for (double x = -0.02; x < 0.015; x += 0.0005) {
    const ToolForce force = simulation.step(ToolPose(Vec3(x, 0.003, 0.002)), kDt);
    CHECK_FALSE((flagged_before && !force.flagged));
    flagged_before = flagged_before || force.flagged;
    if (!force.flagged) last_good = x;
    if (!force.flagged) CHECK(force.force.norm() > 0.1);
  }
  // Triangles of 5 mm that reach into the box may be touched as well.
  CHECK(last_good > -0.015);
  CHECK(last_good < 0.0);
  CHECK(simulation.flagged().outside_reach > 20);
}

TEST_CASE("a capsule that lies across the border of its reach is flagged for the part beyond") {
  Simulation simulation = block({.radius = 0.004, .length = 0.03});
  const Quat along_x = Quat::FromTwoVectors(Vec3::UnitZ(), -Vec3::UnitX());
  const Quat against_x = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX());
  // Its axis goes from the tip against the way it points: 30 mm of it lie beyond the border, or off the
  // block.
  const ToolForce one = simulation.step(ToolPose(Vec3(-0.02, 0.003, 0.002), along_x), kDt);
  Simulation other = block({.radius = 0.004, .length = 0.03});
  const ToolForce two = other.step(ToolPose(Vec3(-0.02, 0.003, 0.002), against_x), kDt);
  CHECK(one.flagged != two.flagged);
}
