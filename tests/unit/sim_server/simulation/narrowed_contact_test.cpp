// Within a step of many instants contact looks around the tools alone (`DeformationModel::narrow`).
#include <algorithm>

#include "sim_server/explicit/cuttable_motion.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/contact_instants.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kStep = 1.0 / 30, kDepth = 0.02;

/// A block under two tools, of which one is far away: a ball, or a capsule, which could touch anywhere along
/// itself, so that contact is looked for everywhere.
Scene scene_of(const char* model, bool narrowed) {
  Scene scene = soft_block_scene(kDepth, model, ElasticLaw::kLinear, 0.003);
  scene.tools[0].cut_buttons = 1;
  scene.tools.push_back(scene.tools[0]);
  scene.tools[1].shape.length = narrowed ? 0 : 0.01;
  scene.cutting = Cutting{.power = 20, .energy = 1e7, .where = "test"};
  if (scene.deformation.model == "hybrid")
    scene.cutting->plan = CutPlan{.point = Vec3::Zero(), .normal = Vec3::UnitX(), .within = 0.012};
  scene.deformation.of<RayleighDamping>().stiffness = 1e-4;
  scene.deformation.of<ContactInstants>().instants = 200;
  return scene;
}

TetMesh block() {
  return soft_block(Vec3(0.06, kDepth, 0.04), {12, 4, 8});
}

}  // namespace

TEST_CASE(
    "narrowed contact: tools that appear deep inside, edges longer than a tool, and tissue held away from "
    "it") {
  struct Kind {
    const char* what;
    double radius;
    bool holds;
  };
  for (const Kind& kind :
       {Kind{"deep", 0.002, false}, Kind{"small", 0.0004, false}, Kind{"held", 0.003, true}}) {
    CAPTURE(kind.what);
    const auto make = [&](bool narrowed) {
      Scene scene = scene_of("tensor_mass", narrowed);
      scene.tools[0].shape.radius = kind.radius;
      if (kind.holds) scene.tools[0].cut_buttons = 0, scene.tools[1].cut_buttons = 1;
      if (kind.holds) scene.tools[0].grasp_place = Vec3(0.001, 0.001, 0.0005);
      return Simulation(scene, block());
    };
    Simulation near = make(true), everywhere = make(false);
    std::vector<ToolInput> inputs(2);
    inputs[1].pose = ToolPose(Vec3(0, 0.3, 0));
    double largest = 0;
    for (int k = 0; k < 40; ++k) {
      // Now and then it is gone, and back in another place.
      const Vec3 place(0.002 + 2e-4 * k, (kind.holds ? 0.004 : -0.011) + 1e-4 * k, 0.001);
      inputs[0].pose.reset();
      if (k % 10 < 8) inputs[0].pose = ToolPose(kind.radius < 0.001 ? place + Vec3(0, 0.0108, 0) : place);
      const Vec3 rendered = near.step(inputs, kStep)[0].force,
                 right = everywhere.step(inputs, kStep)[0].force;
      largest = std::max(largest, right.norm());
      CAPTURE(k, rendered.transpose(), right.transpose());
      REQUIRE((rendered - right).norm() <= 1e-9 * (1e-3 + right.norm()));
    }
    CHECK(largest > 1e-3);
    CHECK(near.state_hash() == everywhere.state_hash());
  }
}

TEST_CASE(
    "narrowed contact: what is loaded where it was not to look moves as it does when it looks everywhere") {
  const Scene scene = scene_of("tensor_mass", true);
  const TetMesh mesh = block();
  const Surface surface = boundary_surface(mesh);
  const std::vector<int> fixed = fixed_vertices(scene, mesh);
  std::vector<int> reachable;
  for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) reachable.push_back(v);
  const Progress progress = [](std::string_view, double) {};
  const ModelInputs inputs{scene, mesh, surface, fixed, reachable, progress};
  CuttableMotion near(inputs), everywhere(inputs);
  const auto top = std::ranges::max_element(surface.vertices, {}, [&](int node) {
    return mesh.vertices[static_cast<std::size_t>(node)].y() -
           std::abs(mesh.vertices[static_cast<std::size_t>(node)].x());
  });
  const int vertex = static_cast<int>(top - surface.vertices.begin());
  const std::vector<Neighbourhood> far{{Vec3(0, 5, 0), 0.001}};
  near.restrict_contact(far, surface.triangles);
  near.free_motion(near.sub_step());
  everywhere.free_motion(near.sub_step());
  for (int k = 0; k < 50; ++k) {
    const std::vector<VertexLoad> loads{{vertex, Vec3(0, -0.1, 0)}};
    const Vec3 published = near.apply(loads)[static_cast<std::size_t>(vertex)],
               right = everywhere.apply(loads)[static_cast<std::size_t>(vertex)];
    CAPTURE(k, published.transpose(), right.transpose());
    REQUIRE(published == right);
    const FreeMotion motion = near.free_motion(near.sub_step());
    everywhere.free_motion(near.sub_step());
    CHECK(std::ranges::count(*motion.moved, vertex) > 0);
  }
  const double went =
      (near.apply({})[static_cast<std::size_t>(vertex)] -
       mesh.vertices[static_cast<std::size_t>(surface.vertices[static_cast<std::size_t>(vertex)])])
          .norm();
  CHECK(went > 1e-6);
}

TEST_CASE("narrowed contact: tissue that was pulled far, and is let go, springs back past another tool") {
  for (const bool lifted : {true, false}) {
    CAPTURE(lifted);
    const auto make = [](bool narrowed) {
      Scene scene = scene_of("tensor_mass", narrowed);
      scene.tools[0].cut_buttons = scene.tools[1].cut_buttons = 0;
      scene.tools[0].grasp_buttons = 1;
      scene.tools.push_back(scene.tools[0]);
      scene.tools[0].shape.radius = 0.006;
      scene.tools[2].grasp_buttons = 0;
      scene.tools[2].shape.radius = 0.0005;
      return Simulation(scene, soft_block(Vec3(0.06, kDepth, 0.04), {24, 6, 16}));
    };
    Simulation near = make(true), everywhere = make(false);
    std::vector<ToolInput> inputs(3);
    inputs[1].pose = ToolPose(Vec3(0, 0.3, 0));
    double largest = 0, late = 0;
    for (int k = 0; k < 40; ++k) {
      const Vec3 held = Vec3(0, 0.0055, 0) + 0.0015 * std::clamp(k - 5, 0, 15) * Vec3(-1, 0.5, 0);
      const bool holds = k > 2 && k < 30;
      inputs[0].buttons = holds || lifted ? 1 : 0;
      inputs[0].pose = ToolPose(held);
      if (lifted && !holds) inputs[0].pose.reset();
      inputs[2].pose = ToolPose(Vec3(0.002, k < 25 ? 0.02 : 0.0002, 0.001));
      const auto rendered = near.step(inputs, kStep), right = everywhere.step(inputs, kStep);
      CAPTURE(k);
      for (const std::size_t i : {0, 2}) {
        CAPTURE(i, rendered[i].force.transpose(), right[i].force.transpose());
        REQUIRE((rendered[i].force - right[i].force).norm() <= 1e-9 * (1e-3 + right[i].force.norm()));
      }
      largest = std::max(largest, right[0].force.norm());
      if (k >= 30) late = std::max(late, right[2].force.norm());
    }
    CHECK(largest > 0.05);
    CHECK(late > 1e-3);
    CHECK(near.state_hash() == everywhere.state_hash());
  }
}

TEST_CASE("contact that looks around the tools alone within a step finds what contact everywhere does") {
  for (const char* model : {"tensor_mass", "hybrid"}) {
    CAPTURE(model);
    Simulation near(scene_of(model, true), block()), everywhere(scene_of(model, false), block());
    std::vector<ToolInput> inputs(2);
    inputs[1].pose = ToolPose(Vec3(0, 0.3, 0));
    int touched = 0;
    for (int k = 0; k < 60; ++k) {
      // Down, then to and fro by 0.4 m/s, cutting for a while, and away.
      const double down = std::min(0.006, 0.0005 * k), along = k < 15 ? 0 : 0.008 * std::sin(1.6 * (k - 15));
      inputs[0].pose = ToolPose(Vec3(along, 0.004 - down + (k > 50 ? 0.02 : 0), 0.0005));
      inputs[0].buttons = k > 25 && k < 40 ? 1 : 0;
      const Vec3 rendered = near.step(inputs, kStep)[0].force;
      const Vec3 right = everywhere.step(inputs, kStep)[0].force;
      touched += right.norm() > 0 ? 1 : 0;
      CAPTURE(k, rendered.transpose(), right.transpose());
      REQUIRE((rendered - right).norm() <= 1e-9 * (1e-3 + right.norm()));
    }
    CHECK(touched > 20);
    CHECK(everywhere.resection()->totals().tetrahedra > 5);
    CHECK(near.state_hash() == everywhere.state_hash());
  }
}
