// A tool comes to stand on the side of the surface that it touched, whatever the solver went through, or its
// answers are flagged: it is never found on another side.
#include "sim_server/models/implicit.h"
#include "sim_server/models/spring.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kDt = 1.0 / 30, kRadius = 0.004;

/// On `thick_block`, but for the last bits of its vertices.
Simulation organ(const Scene& scene) {
  return {scene, grid_block(lines(-0.015, 0.015, 6), lines(-0.015, 0, 3), lines(-0.015, 0.015, 6))};
}

}  // namespace

TEST_CASE("a tool that the tissue closed over is taken back to the side it touched, not to the nearest") {
  // 10.5 mm into 15 mm, so that elements turn inside out on the way; the held bottom is 4.5 mm below the
  // tool.
  const Vec3 deep(0.001, kRadius - 0.0105, 0.002);
  for (const ElasticLaw law : {ElasticLaw::kCorotational, ElasticLaw::kNeoHookean}) {
    const Scene scene = thick_block_scene("implicit", law, kRadius);
    Simulation at_once = organ(scene), slowly = organ(scene);
    double most = 0;
    for (int i = 0; i < 60; ++i)
      most = std::max(most, slowly.step(ToolPose(deep + (1 - i / 59.0) * Vec3(0, 0.0125, 0)), kDt).force.y());
    REQUIRE(most > 1);
    ToolForce published;
    for (int i = 0; i < 90; ++i) {
      published = at_once.step(ToolPose(deep), kDt);
      CAPTURE(static_cast<int>(law), i, published.force.transpose(), most);
      CHECK((published.flagged || published.force.y() > 0));
      CHECK((published.flagged || published.force.norm() < 3 * most));
    }
    CHECK_FALSE(published.flagged);
    CHECK(published.force.y() > 0);
  }
}

TEST_CASE("two tools that pinch what cannot give way stay where they were, flagged, and find back") {
  // A body on a spring of 800 N/m: no place is left for it once both tools are 1 mm beyond its sides.
  Scene scene = thick_block_scene("spring", ElasticLaw::kLinear, kRadius);
  scene.deformation.of<SpringSettings>().stiffness = Vec3(800, 800, 800);
  scene.tools.push_back(scene.tools.front());
  Simulation simulation = organ(scene);
  const double touching = 0.015 + kRadius;
  const auto step = [&](double left, double right) {  // how far each presses into the sides at rest, m
    const std::vector<ToolInput> inputs{{.pose = ToolPose(Vec3(-touching + left, -0.005, 0.002))},
                                        {.pose = ToolPose(Vec3(touching - right, -0.005, 0.002))}};
    return simulation.step(inputs, kDt);
  };
  step(-0.002, -0.002);
  CHECK(step(0.001, -0.002)[0].force.x() == Approx(-0.8));
  for (int i = 0; i <= 40; ++i) {
    const double depth = 0.005 * std::min(1.0, i / 20.0);
    const auto rendered = step(depth, depth);
    CAPTURE(i, rendered[0].force.transpose(), rendered[1].force.transpose());
    if (i > 0) CHECK((rendered[0].flagged && rendered[1].flagged));
    CHECK(rendered[0].force.x() < 1e-9);
    CHECK(rendered[1].force.x() > -1e-9);
    CHECK(rendered[0].force.norm() < 8);
  }
  const auto alone = step(-0.002, 0.001);
  CHECK(alone[0].force.norm() == 0);
  CHECK(alone[1].force.x() == Approx(0.8));
  CHECK_FALSE(alone[1].flagged);
}
