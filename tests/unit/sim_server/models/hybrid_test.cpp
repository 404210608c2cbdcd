#include "sim_server/models/hybrid.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/contact_instants.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/cut_bodies.h"
#include "tests/support/soft_block.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kStep = 1.0 / 30;  // s
constexpr double kDepth = 0.02;     // m

TetMesh block() {
  return soft_block(Vec3(0.06, kDepth, 0.04), {12, 4, 8});
}

/// A block that can be cut within 6 mm of its middle plane, so that two parts of it are condensed.
Scene hybrid_scene(int layers = 1) {
  Scene scene = soft_block_scene(kDepth, "hybrid", ElasticLaw::kLinear, 0.003);
  scene.tools[0].cut_buttons = 1;
  scene.cutting = Cutting{.power = 2, .energy = 1e7, .where = "test"};
  scene.cutting->plan = CutPlan{.point = Vec3::Zero(), .normal = Vec3::UnitX(), .within = 0.006};
  scene.deformation.of<RayleighDamping>().stiffness = 1e-4;
  scene.deformation.of<ContactInstants>().instants = 200;
  scene.deformation.of<HybridSettings>().layers = layers;
  return scene;
}

Scene static_scene() {
  return soft_block_scene(kDepth, "quasi_static", ElasticLaw::kLinear, 0.003);
}

TetMesh what_is_remaining(const Simulation& simulation) {
  return rest_of(simulation.mesh(), simulation.resection()->remaining());
}

ToolAnswer apply_loads(Simulation& simulation, const Vec3& p, bool hot = false) {
  return step(simulation, p, {.buttons = static_cast<std::uint16_t>(hot ? 1 : 0)}, kStep);
}

/// What a body at rest answers to a tool that comes down to `p`.
ToolAnswer pressed_slowly(Simulation& simulation, const Vec3& p) {
  ToolAnswer rendered;
  for (int i = 22; i >= 0; --i) rendered = apply_loads(simulation, p + Vec3(0, 5e-4 * i, 0));
  return rendered;
}

}  // namespace

TEST_CASE("hybrid: at rest it bears a tool as the whole body at rest does, wherever it presses") {
  Simulation entire(static_scene(), block());
  for (const int layers : {0, 2}) {
    Simulation hybrid(hybrid_scene(layers), block());
    for (const Vec3& p :
         {Vec3(0.001, -0.001, 0.0005), Vec3(0.011, -0.001, 0.0015), Vec3(0.022, -0.001, 0.001)}) {
      CAPTURE(layers, p.x());
      const Vec3 right = pressed_slowly(entire, p).force;
      pressed_slowly(hybrid, p);
      ToolAnswer rendered;
      for (int i = 0; i < 240; ++i) rendered = apply_loads(hybrid, p);
      REQUIRE(right.norm() > 0.1);
      CHECK((rendered.force - right).norm() < 1e-6 * right.norm());
      double apart = 0;
      for (std::size_t v = 0; v < entire.rest().size(); ++v) {
        const auto& all = hybrid.surface().vertices;
        const auto there = std::ranges::find(all, entire.surface().vertices[v]) - all.begin();
        apart = std::max(
            apart, (hybrid.positions()[static_cast<std::size_t>(there)] - entire.positions()[v]).norm());
      }
      CHECK(apart < 1e-8);
    }
  }
}

TEST_CASE("hybrid: cut, it bears a tool at rest as a body that was never whole") {
  Scene scene = hybrid_scene();
  scene.deformation.of<ContactInstants>().instants = 800;  // in a pit contact chatters at longer ones
  Simulation hybrid(scene, block());
  for (int i = 0; i < 45; ++i) apply_loads(hybrid, Vec3(0.001, 0.001, 0.0005), true);
  REQUIRE(hybrid.resection()->totals().tetrahedra > 5);
  Simulation entire(static_scene(), what_is_remaining(hybrid));
  const Vec3 place(0.001, -0.001, 0.0005);
  const Vec3 right = pressed_slowly(entire, place).force;
  ToolAnswer rendered;
  for (int i = 0; i < 300; ++i) rendered = apply_loads(hybrid, place);
  REQUIRE(right.norm() > 0.05);
  CHECK((rendered.force - right).norm() < 1e-6 * right.norm());
}

TEST_CASE("hybrid: with all of the body in motion it is tensor_mass, to the last bit") {
  Scene scene = hybrid_scene(100);
  Simulation hybrid(scene, block());
  scene.deformation.model = "tensor_mass";
  Simulation moving(scene, block());
  for (int i = 0; i < 40; ++i) {
    const Vec3 p(0.0002 * i, 0.001 - 5e-5 * i, 0);
    CHECK(apply_loads(hybrid, p, true).force == apply_loads(moving, p, true).force);
  }
  CHECK(hybrid.resection()->totals().tetrahedra > 3);
  CHECK(hybrid.state_hash() == moving.state_hash());
}

TEST_CASE("hybrid: undamped, it keeps its energy") {
  Scene scene = hybrid_scene(0);
  scene.deformation.of<RayleighDamping>() = {.mass = 0, .stiffness = 0};
  Simulation hybrid(scene, block());
  for (int i = 0; i < 10; ++i) apply_loads(hybrid, Vec3(0.001, -0.002, 0.0005));
  const auto largest_of = [&](int steps) {  // displacement while it swings free
    double most = 0;
    std::vector<ToolInput> lifted(1);
    for (int i = 0; i < steps; ++i) {
      hybrid.step(lifted, kStep);
      for (std::size_t v = 0; v < hybrid.rest().size(); ++v)
        most = std::max(most, (hybrid.positions()[v] - hybrid.rest()[v]).norm());
    }
    return most;
  };
  const double early = largest_of(60);
  REQUIRE(early > 1e-4);
  largest_of(600);
  const double late = largest_of(60);
  CHECK(late < 1.5 * early);
  CHECK(late > 0.5 * early);
}

TEST_CASE("hybrid: with modes of the rest it moves as the whole body in motion does, with none not") {
  const TetMesh mesh = block();
  const Surface surface = boundary_surface(mesh);
  Scene scene = hybrid_scene(0);
  scene.deformation.of<RayleighDamping>() = {.mass = 5, .stiffness = 2e-5};
  scene.fixed.front().box = Box{Vec3(-1, -1, -1), Vec3(-0.0299, 1, 1)};  // its left end
  const std::vector<int> fixed = fixed_vertices(scene, mesh);
  std::vector<int> reachable(surface.vertices.size());
  std::iota(reachable.begin(), reachable.end(), 0);
  const ModelInputs inputs{scene, mesh, surface, fixed, reachable, kSilent};
  const auto nearest_to = [&](const Vec3& place) {
    const auto away = [&](int v) { return (mesh.vertices[surface.vertices[v]] - place).norm(); };
    return *std::ranges::min_element(reachable, {}, away);
  };
  const int cuttable = nearest_to(Vec3::Zero()), condensed = nearest_to(Vec3(0.03, 0, 0));
  const auto swing = [&](DeformationModel& model) {  // pushed at both for a while, then free
    std::vector<std::vector<Vec3>> seen;
    for (int i = 0; i < 800; ++i) {
      const Vec3 force = i < 400 ? Vec3(0.02, -0.1, 0.01) : Vec3(Vec3::Zero());
      model.free_motion(kStep / 200);
      const auto at = model.apply(std::vector<VertexLoad>{{cuttable, force}, {condensed, 0.5 * force}});
      if (i % 20 == 19) seen.push_back({at[cuttable], at[condensed]});
    }
    return seen;
  };
  const auto right = swing(*std::make_unique<CuttableMotion>(inputs));
  const auto error_with = [&](int modes) {
    scene.deformation.of<HybridSettings>().condensed_modes = modes;
    const auto found = swing(*Hybrid::make(inputs));
    double error = 0, all = 0;
    for (std::size_t i = 0; i < right.size(); ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        error += (found[i][k] - right[i][k]).squaredNorm();
        all += (right[i][k] - right[0][k]).squaredNorm();
      }
    }
    return std::sqrt(error / all);
  };
  const double none = error_with(0), some = error_with(20), all = error_with(1000);
  INFO(none << " " << some << " " << all);
  CHECK(none > 0.2);  // it swings at other frequencies
  CHECK(some < 0.2 * none);
  CHECK(all < 0.05);
}

TEST_CASE("hybrid: undamped, a tool that presses on the rest beside its border brings no energy in") {
  for (const double x : {0.0105, 0.016}) {
    CAPTURE(x);
    Scene scene = hybrid_scene(0);
    scene.deformation.of<RayleighDamping>() = {.mass = 0, .stiffness = 0};
    scene.tools[0].grasp_buttons = 2;
    Simulation hybrid(scene, block());
    double early = 0, late = 0;
    for (int i = 0; i < 400; ++i) {
      const Vec3 p(x, 0.002 - (i < 10 ? 0.0004 * i : 0.004), 0.0005);
      const double force = step(hybrid, p, {.buttons = 2}, kStep).force.norm();
      if (i >= 20 && i < 80) early = std::max(early, force);
      if (i >= 340) late = std::max(late, force);
    }
    REQUIRE(early > 0.05);
    CHECK(late < 1.5 * early);
    CHECK(hybrid.flagged().to_text().empty());
  }
}

TEST_CASE("hybrid: a piece that is cut off goes with what of it is condensed") {
  Scene scene = hybrid_scene(0);
  scene.tools[0].shape.radius = 0.05;
  scene.cutting->power = 1e5;
  scene.cutting->spot = 0.05;
  scene.cutting->smallest_piece = 1;
  TetMesh mesh = block();
  // Held at its left end only, so that the right one is cut off.
  scene.fixed.front().box = Box{Vec3(-1, -1, -1), Vec3(-0.0299, 1, 1)};
  Simulation hybrid(scene, mesh);
  const std::size_t all = mesh.tetrahedra.size();
  for (int i = 0; i < 60; ++i) apply_loads(hybrid, Vec3(0, 0.0495, 0), true);
  const ResectionTotals& totals = hybrid.resection()->totals();
  CHECK(totals.dropped_pieces > 0);
  CHECK(totals.tetrahedra > all / 2);
  CHECK(hybrid.resection()->remaining().count() < all / 2);
  for (const Vec3& x : hybrid.positions()) CHECK(x.norm() < 0.1);
  for (const Triangle& triangle : hybrid.surface().triangles) {
    for (const int v : triangle) CHECK(hybrid.rest()[static_cast<std::size_t>(v)].x() < 1e-2);
  }
}

TEST_CASE("hybrid: it says what it lacks") {
  Scene scene = hybrid_scene();
  scene.cutting.reset();
  CHECK_THROWS_WITH(Simulation(scene, block()), Catch::Contains("needs a [cutting]"));
}
