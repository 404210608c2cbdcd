// Tools on tissue in motion, each vertex of which gives way by itself over a sub-step: when one has to meet
// it again, as others load it, too, and what one holds of it.
#include "sim_server/contact/tissue.h"

#include <algorithm>

#include "sim_server/contact/grip.h"
#include "sim_server/explicit/cuttable_motion.h"
#include "sim_server/tissue/model_inputs.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDepth = 0.02, kRadius = 0.003;  // m

Scene scene_of_block() {
  Scene scene = test::soft_block_scene(kDepth, "tensor_mass", ElasticLaw::kLinear, kRadius);
  scene.tools[0].cut_buttons = 1;
  scene.cutting = Cutting{.power = 20, .energy = 1e7, .where = "test"};
  scene.deformation.of<RayleighDamping>().stiffness = 1e-4;
  return scene;
}

/// A block at rest that two tools may load, and which of its surface vertices are free.
struct Block {
  Scene scene = scene_of_block();
  TetMesh mesh = test::soft_block(Vec3(0.06, kDepth, 0.04), {12, 4, 8});
  Surface surface = boundary_surface(mesh);
  std::vector<int> fixed = fixed_vertices(scene, mesh), free;
  Tissue tissue;

  Block() {
    for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) {
      if (!std::ranges::binary_search(fixed, surface.vertices[static_cast<std::size_t>(v)]))
        free.push_back(v);
    }
    const Progress progress = [](std::string_view, double) {};
    tissue.model = std::make_unique<CuttableMotion>(ModelInputs{scene, mesh, surface, fixed, free, progress});
    tissue.traits = tissue.model->traits();
    tissue.free = tissue.positions = tissue.model->free_motion(0).positions;
    tissue.reserve(std::vector<int>{128, 128}, std::vector<double>{kRadius, kRadius});
  }
  /// How far a vertex goes per force on it, m/N.
  double compliance(int vertex) {
    const VertexLoad load{vertex, Vec3(0, 1, 0)};
    const auto v = static_cast<std::size_t>(vertex);
    return (tissue.model->apply({&load, 1})[v] - tissue.free[v]).y();
  }
};

}  // namespace

TEST_CASE("tissue: what others move matters to a tool where that met it, or where it may come to meet it") {
  Block block;
  Tissue& tissue = block.tissue;
  const int touched = block.free.front(), other = block.free.back();
  const double compliance = block.compliance(other);
  REQUIRE(compliance > 0);
  const auto load_by_other = [&](int vertex, double newton) {
    ToolTissue second = tissue.touched_by(1);
    const VertexLoad load{vertex, Vec3(0, newton, 0)};
    second.set_loads({&load, 1});
    second.apply_loads();
  };
  const auto matters = [&](bool any, int vertex, double way) {
    load_by_other(other, 0);
    ToolTissue first = tissue.touched_by(0);
    any ? first.mark_solved() : first.mark_solved({&touched, 1});
    load_by_other(vertex, way / compliance);
    return tissue.touched_by(0).moved();
  };
  CHECK(!matters(false, other, 0.1 * kRadius));
  CHECK(matters(true, other, 0.1 * kRadius));
  CHECK(matters(false, touched, 0.1 * kRadius));
  CHECK(matters(false, other, 0.3 * kRadius));
  CHECK(!matters(true, other, 1e-10 * kRadius));
}

TEST_CASE("grip: of vertices that give way by themselves each takes its own load, in one round") {
  Block block;
  ToolSettings tool = block.scene.tools[0];
  std::vector<Vec3> rest(block.tissue.free.begin(), block.tissue.free.end());
  tool.grasp_place = rest[static_cast<std::size_t>(block.free[block.free.size() / 2])];
  tool.shape.radius = 0.006;
  Grip grip(tool, rest, block.surface.triangles, 100);
  REQUIRE(grip.vertices().size() > 5);
  const Vec3 way(1e-4, 2e-4, -3e-4);  // m
  const Grip::Pull pull = grip.pull(*tool.grasp_place + way, block.tissue.touched_by(0));
  CHECK(pull.converged);
  CHECK(pull.rounds == 1);
  const std::vector<VertexLoad> loads(block.tissue.loads_of(0).begin(), block.tissue.loads_of(0).end());
  REQUIRE(loads.size() == grip.vertices().size());
  double stiffness = 0;  // N/m
  for (const VertexLoad& load : loads) {
    const double compliance = block.compliance(load.vertex);
    CHECK((load.force - way / compliance).norm() <= 1e-5 * load.force.norm());
    stiffness += 1 / compliance;
  }
  CHECK((pull.force + stiffness * way).norm() <= 1e-5 * pull.force.norm());
  CHECK((pull.tangent + stiffness * Mat3::Identity()).norm() <= 1e-5 * pull.tangent.norm());
}
