// Within a step of many instants contact looks around the tools alone (`DeformationModel::narrow`).
#include "sim_server/deformation/contact_instants.h"
#include "sim_server/deformation/rayleigh_damping.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kStep = 1.0 / 30, kDepth = 0.02;

/// A block under two tools, of which one is far away: a ball, or a capsule, which could touch anywhere along
/// itself, so that contact is looked for everywhere.
Simulation block_of(const char* model, bool narrowed) {
  Scene scene = soft_block_scene(kDepth, model, ElasticLaw::kLinear, 0.003);
  scene.tools[0].cut_buttons = 1;
  scene.tools.push_back(scene.tools[0]);
  scene.tools[1].shape.length = narrowed ? 0 : 0.01;
  scene.cutting = Cutting{.power = 20, .energy = 1e7, .where = "test"};
  if (scene.deformation.model == "hybrid")
    scene.cutting->plan = CutPlan{.point = Vec3::Zero(), .normal = Vec3::UnitX(), .within = 0.012};
  scene.deformation.of<RayleighDamping>().stiffness = 1e-4;
  scene.deformation.of<ContactInstants>().instants = 200;
  return Simulation(scene, soft_block(Vec3(0.06, kDepth, 0.04), {12, 4, 8}));
}

}  // namespace

TEST_CASE("contact that looks around the tools alone within a step finds what contact everywhere does") {
  for (const char* model : {"tensor_mass", "hybrid"}) {
    CAPTURE(model);
    Simulation near = block_of(model, true), everywhere = block_of(model, false);
    std::vector<ToolInput> inputs(2);
    inputs[1].pose = ToolPose(Vec3(0, 0.3, 0));
    int touched = 0;
    for (int k = 0; k < 60; ++k) {
      // Down, then to and fro by 0.4 m/s, cutting for a while, and away.
      const double down = std::min(0.006, 0.0005 * k), along = k < 15 ? 0 : 0.008 * std::sin(1.6 * (k - 15));
      inputs[0].pose = ToolPose(Vec3(along, 0.004 - down + (k > 50 ? 0.02 : 0), 0.0005));
      inputs[0].buttons = k > 25 && k < 40 ? 1 : 0;
      const Vec3 felt = near.step(inputs, kStep)[0].force;
      const Vec3 right = everywhere.step(inputs, kStep)[0].force;
      touched += right.norm() > 0 ? 1 : 0;
      CAPTURE(k, felt.transpose(), right.transpose());
      REQUIRE((felt - right).norm() <= 1e-9 * (1e-3 + right.norm()));
    }
    CHECK(touched > 20);
    CHECK(everywhere.resection()->totals().tetrahedra > 5);
    CHECK(near.state_hash() == everywhere.state_hash());
  }
}
