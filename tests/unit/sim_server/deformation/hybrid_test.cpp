#include "sim_server/deformation/hybrid.h"

#include <algorithm>

#include "sim_server/deformation/contact_instants.h"
#include "sim_server/deformation/rayleigh_damping.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
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
Scene hybrid_scene(int layers = 1, int follow_every = 8) {
  Scene scene = soft_block_scene(kDepth, "hybrid", ElasticLaw::kLinear, 0.003);
  scene.tools[0].cut_buttons = 1;
  scene.cutting = Cutting{.power = 2, .energy = 1e7, .where = "test"};
  scene.cutting->plan = CutPlan{.point = Vec3::Zero(), .normal = Vec3::UnitX(), .within = 0.006};
  scene.deformation.of<RayleighDamping>().stiffness = 1e-4;
  scene.deformation.of<ContactInstants>().instants = 200;
  scene.deformation.of<HybridSettings>() = {layers, follow_every};
  return scene;
}

Scene static_scene() {
  return soft_block_scene(kDepth, "quasi_static", ElasticLaw::kLinear, 0.003);
}

TetMesh what_is_left(const Simulation& simulation) {
  TetMesh rest = simulation.mesh();
  rest.tetrahedra.clear();
  for (std::size_t t = 0; t < simulation.mesh().tetrahedra.size(); ++t) {
    if (simulation.resection()->left().is_left(static_cast<int>(t)))
      rest.tetrahedra.push_back(simulation.mesh().tetrahedra[t]);
  }
  return rest;
}

ToolAnswer press(Simulation& simulation, const Vec3& p, bool hot = false) {
  return step(simulation, p, {.buttons = static_cast<std::uint16_t>(hot ? 1 : 0)}, kStep);
}

/// What a body at rest answers to a tool that comes down to `p`.
ToolAnswer pressed_slowly(Simulation& simulation, const Vec3& p) {
  ToolAnswer felt;
  for (int i = 22; i >= 0; --i) felt = press(simulation, p + Vec3(0, 5e-4 * i, 0));
  return felt;
}

}  // namespace

TEST_CASE("hybrid: at rest it bears a tool as the whole body at rest does, wherever it presses") {
  Simulation whole(static_scene(), block());
  for (const int follow_every : {1, 8, 200}) {
    Simulation hybrid(hybrid_scene(1, follow_every), block());
    for (const Vec3& p :
         {Vec3(0.001, -0.001, 0.0005), Vec3(0.011, -0.001, 0.0015), Vec3(0.022, -0.001, 0.001)}) {
      CAPTURE(follow_every, p.x());
      const Vec3 right = pressed_slowly(whole, p).force;
      pressed_slowly(hybrid, p);
      ToolAnswer felt;
      for (int i = 0; i < 240; ++i) felt = press(hybrid, p);
      REQUIRE(right.norm() > 0.1);
      CHECK((felt.force - right).norm() < 1e-6 * right.norm());
      double apart = 0;
      for (std::size_t v = 0; v < whole.rest().size(); ++v) {
        const auto& all = hybrid.surface().vertices;
        const auto there = std::ranges::find(all, whole.surface().vertices[v]) - all.begin();
        apart = std::max(apart,
                         (hybrid.positions()[static_cast<std::size_t>(there)] - whole.positions()[v]).norm());
      }
      CHECK(apart < 1e-8);
    }
  }
}

TEST_CASE("hybrid: cut, it bears a tool at rest as a body that was never whole") {
  Simulation hybrid(hybrid_scene(), block());
  for (int i = 0; i < 45; ++i) press(hybrid, Vec3(0.001, 0.001, 0.0005), true);
  REQUIRE(hybrid.resection()->totals().tetrahedra > 5);
  Simulation whole(static_scene(), what_is_left(hybrid));
  const Vec3 place(0.001, -0.001, 0.0005);
  const Vec3 right = pressed_slowly(whole, place).force;
  ToolAnswer felt;
  for (int i = 0; i < 300; ++i) felt = press(hybrid, place);
  REQUIRE(right.norm() > 0.05);
  CHECK((felt.force - right).norm() < 1e-6 * right.norm());
}

TEST_CASE("hybrid: with all of the body in motion it is tensor_mass, to the last bit") {
  Scene scene = hybrid_scene(100);
  Simulation hybrid(scene, block());
  scene.deformation.model = "tensor_mass";
  Simulation moving(scene, block());
  for (int i = 0; i < 40; ++i) {
    const Vec3 p(0.0002 * i, 0.001 - 5e-5 * i, 0);
    CHECK(press(hybrid, p, true).force == press(moving, p, true).force);
  }
  CHECK(hybrid.resection()->totals().tetrahedra > 3);
  CHECK(hybrid.state_hash() == moving.state_hash());
}

TEST_CASE("hybrid: undamped, it only ever loses energy where the rest is late") {
  for (const int follow_every : {1, 7, 40, 1000}) {
    CAPTURE(follow_every);
    Scene scene = hybrid_scene(0, follow_every);
    scene.deformation.of<RayleighDamping>() = {.mass = 0, .stiffness = 0};
    Simulation hybrid(scene, block());
    for (int i = 0; i < 10; ++i) press(hybrid, Vec3(0.001, -0.002, 0.0005));
    const auto largest = [&] {
      double most = 0;
      for (std::size_t v = 0; v < hybrid.rest().size(); ++v)
        most = std::max(most, (hybrid.positions()[v] - hybrid.rest()[v]).norm());
      return most;
    };
    const double before = largest();
    REQUIRE(before > 1e-3);
    std::vector<ToolInput> lifted(1);
    double after = 0;
    for (int i = 0; i < 300; ++i) {
      hybrid.step(lifted, kStep);
      if (i >= 270) after = std::max(after, largest());
    }
    CHECK(after < (follow_every == 1 ? 1.0 : 0.5) * before);
  }
}

TEST_CASE("hybrid: what tools feel in motion hardly depends on how often the rest follows") {
  std::vector<Vec3> right;
  for (const int follow_every : {1, 8}) {
    Simulation hybrid(hybrid_scene(1, follow_every), block());
    double error = 0, largest = 0;
    for (int i = 0; i < 60; ++i) {
      const double depth = 0.001 * (1 - std::cos(2 * M_PI * 2.5 * i * kStep));
      const Vec3 force = press(hybrid, Vec3(0.001, 0.003 - 2 * depth, 0.0005)).force;
      if (follow_every == 1) {
        right.push_back(force);
        continue;
      }
      error = std::max(error, (force - right[static_cast<std::size_t>(i)]).norm());
      largest = std::max(largest, right[static_cast<std::size_t>(i)].norm());
    }
    if (follow_every == 1) continue;
    REQUIRE(largest > 0.1);
    CHECK(error < 0.01 * largest);
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
  for (int i = 0; i < 60; ++i) press(hybrid, Vec3(0, 0.0495, 0), true);
  const ResectionTotals& totals = hybrid.resection()->totals();
  CHECK(totals.dropped_pieces > 0);
  CHECK(totals.tetrahedra > all / 2);
  CHECK(hybrid.resection()->left().count() < all / 2);
  for (const Vec3& x : hybrid.positions()) CHECK(x.norm() < 0.1);
  for (const Triangle& triangle : hybrid.surface().triangles) {
    for (const int v : triangle) CHECK(hybrid.rest()[static_cast<std::size_t>(v)].x() < 1e-2);
  }
}

TEST_CASE("hybrid: it says what it lacks") {
  Scene scene = hybrid_scene();
  scene.cutting.reset();
  CHECK_THROWS_WITH(Simulation(scene, block()), Catch::Contains("the scene has none"));
}
