// The tensor-mass model, alone and in a whole simulation.
#include "sim_server/models/tensor_mass.h"

#include <algorithm>

#include "common/error.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/models/quasi_static.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/dense_tissue.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/solids.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kPeriod = 1.0 / 30;

/// Models without a simulation: all of the surface within reach, or its top.
struct Bench {
  TetMesh mesh = test::shallow_block();
  Surface surface = boundary_surface(mesh);
  Scene scene = test::shallow_block_scene("tensor_mass");
  std::vector<int> fixed = fixed_vertices(scene, mesh), reachable;

  Bench() {
    for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) {
      if (at(v)[1] > -0.001) reachable.push_back(v);
    }
  }
  const Vec3& at(int v) const { return mesh.vertices[surface.vertices[v]]; }
  ModelInputs inputs() const { return {scene, mesh, surface, fixed, reachable, kSilent}; }
  /// The free top vertex nearest to a place.
  int top(double x, double z) const {
    return *std::ranges::min_element(reachable, [&](int a, int b) {
      return (at(a) - Vec3(x, 0, z)).squaredNorm() < (at(b) - Vec3(x, 0, z)).squaredNorm();
    });
  }
};

double largest(std::span<const Vec3> a, std::span<const Vec3> b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

std::string refusal(const Bench& bench) {
  try {
    TensorMass model(bench.inputs());
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

}  // namespace

TEST_CASE("tensor_mass: a period is cut into as few sub-steps as the highest frequency allows") {
  const Bench bench;
  const TensorMass model(bench.inputs());
  const double longest =
      longest_sub_step(highest_frequency(ElasticTensors(bench.mesh, *bench.scene.material, bench.fixed)),
                       {bench.scene.deformation.of<RayleighDamping>().mass,
                        bench.scene.deformation.of<RayleighDamping>().stiffness});
  CHECK(model.sub_steps() * model.sub_step() == Approx(kPeriod).epsilon(1e-14));
  CHECK(model.sub_step() < 0.96 * longest);
  CHECK(model.sub_step() * model.sub_steps() / (model.sub_steps() - 1) > 0.94 * longest);
}

TEST_CASE("tensor_mass: what loads do in a period is what stepping through it does, period by period") {
  const Bench bench;
  TensorMass model(bench.inputs());
  const Material& material = *bench.scene.material;
  const ElasticTensors tensors(bench.mesh, material, bench.fixed);
  ExplicitMotion twin(tensors, {bench.scene.deformation.of<RayleighDamping>().mass,
                                bench.scene.deformation.of<RayleighDamping>().stiffness});
  const auto off = [&](std::span<const Vec3> positions, const std::vector<int>& vertices) {
    double most = 0;
    for (const int v : vertices) {
      const int place = tensors.places()[bench.surface.vertices[v]];
      const Vec3 u =
          place < 0 ? Vec3(Vec3::Zero()) : Vec3(Eigen::Map<const Vec3>(twin.state.u.data() + 3 * place));
      most = std::max(most, (positions[v] - bench.at(v) - u).norm());
    }
    return most;
  };
  std::vector<int> all;
  for (int v = 0; v < static_cast<int>(bench.surface.vertices.size()); ++v) all.push_back(v);
  const int a = bench.top(0, 0), b = bench.top(0.01, -0.004);
  const std::vector<double> none = twin.state.f;
  for (int period = 0; period < 6; ++period) {
    const ExplicitMotion::State begin = twin.state;
    twin.run(model.sub_steps(), model.sub_step(), none);
    const FreeMotion motion = model.free_motion(kPeriod * (period % 2 == 0 ? 1.01 : 0.99));
    CHECK(motion.velocities.empty());
    CHECK(off(motion.positions, all) < 1e-15);
    const std::vector<VertexLoad> loads{{a, Vec3(0.05, -0.2, 0.01 * period)}, {b, Vec3(0, -0.1, 0)}};
    const auto moved = model.apply(period == 3 ? std::span<const VertexLoad>() : loads);
    if (period == 3) continue;
    std::vector<double> force = none;
    for (const VertexLoad& load : loads)
      Eigen::Map<Vec3>(force.data() + 3 * tensors.places()[bench.surface.vertices[load.vertex]]) = load.force;
    twin.state = begin;
    twin.run(model.sub_steps(), model.sub_step(), force);
    CHECK(off(moved, bench.reachable) < 1e-12 * 0.002);  // they go by millimetres
  }
}

TEST_CASE("tensor_mass: under a constant load it comes to rest where quasi_static stands") {
  const Bench bench;
  TensorMass model(bench.inputs());
  QuasiStatic still(bench.inputs());
  const std::vector<VertexLoad> loads{{bench.top(0, 0), Vec3(0.05, -0.2, 0)},
                                      {bench.top(-0.01, 0.01), Vec3(0, -0.1, 0.1)}};
  const auto expected = still.apply(loads);
  std::vector<Vec3> rest;
  for (int v = 0; v < static_cast<int>(bench.surface.vertices.size()); ++v) rest.push_back(bench.at(v));
  std::span<const Vec3> moved;
  for (int i = 0; i < 100; ++i) {
    model.free_motion(kPeriod);
    moved = model.apply(loads);
  }
  double most = 0;
  for (const int v : bench.reachable) most = std::max(most, (moved[v] - expected[v]).norm());
  CHECK(most < 1e-6 * largest(expected, rest));
}

TEST_CASE("tensor_mass: its nodes inside are those of a body at equilibrium, once it has come to rest") {
  const Bench bench;
  TensorMass model(bench.inputs());
  CHECK(std::ranges::equal(model.nodes(), bench.mesh.vertices));
  const std::vector<VertexLoad> loads{{bench.top(0, 0), Vec3(0.05, -0.2, 0)}};
  std::span<const Vec3> surface;
  for (int i = 0; i < 100; ++i) {
    model.free_motion(kPeriod);
    surface = model.apply(loads);
  }
  const std::vector<Vec3> nodes(model.nodes().begin(), model.nodes().end());
  REQUIRE(nodes.size() == bench.mesh.vertices.size());
  double off = 0;
  for (const int v : bench.reachable)
    off = std::max(off, (nodes[bench.surface.vertices[v]] - surface[v]).norm());
  CHECK(off < 1e-6 * largest(nodes, bench.mesh.vertices));
  // The body pulls at its loaded node alone, and at its supports.
  const Solid solid(bench.mesh, *bench.scene.material);
  std::vector<Vec3> forces(nodes.size());
  solid.forces(nodes, forces);
  const int loaded = bench.surface.vertices[loads.front().vertex];
  CHECK((forces[loaded] - loads.front().force).norm() < 1e-4 * loads.front().force.norm());
  for (int node = 0; node < solid.nodes(); ++node) {
    if (node == loaded || std::ranges::binary_search(bench.fixed, node)) continue;
    CHECK(forces[node].norm() < 1e-4 * loads.front().force.norm());
  }
}

TEST_CASE("tensor_mass: without damping its compliance is positive all the same") {
  Bench bench;
  bench.scene.deformation.of<RayleighDamping>().mass =
      bench.scene.deformation.of<RayleighDamping>().stiffness = 0;
  for (const double rate : {30.0, 200.0, 5000.0}) {
    bench.scene.rate_hz = rate;
    const TensorMass model(bench.inputs());
    const auto n = static_cast<Eigen::Index>(bench.reachable.size());
    ContactPatch patch;
    patch.reserve(static_cast<int>(n), 1);
    model.compliance(bench.reachable, patch);
    CHECK(test::eigenvalues(patch.compliance.topLeftCorner(3 * n, 3 * n)).minCoeff() > 0);
  }
}

TEST_CASE("tensor_mass: no time, no motion, any other step is a period") {
  const Bench bench;
  TensorMass model(bench.inputs()), other(bench.inputs());
  const std::vector<VertexLoad> loads{{bench.top(0, 0), Vec3(0, -0.2, 0)}};
  for (TensorMass* const m : {&model, &other}) {
    m->free_motion(kPeriod);
    m->apply(loads);
  }
  const std::span<const Vec3> at = other.free_motion(0).loaded;
  CHECK(largest(at, model.apply(loads)) == 0);
  CHECK(largest(model.free_motion(0.03).positions, other.free_motion(0.04).positions) == 0);
}

TEST_CASE("tensor_mass: what cannot be is refused in one line") {
  Bench bench;
  bench.scene.rate_hz = 0;
  bench.scene.rate_where = "liver.toml:4";
  CHECK(refusal(bench) ==
        "liver.toml:4: `rate_hz` = 0, but model \"tensor_mass\" must know the time of a step beforehand; "
        "name a "
        "rate, such as 30");
  bench.scene.rate_hz = 30;
  bench.scene.material->young_modulus = 1e12;
  CHECK(refusal(bench).find("is for soft tissue") != std::string::npos);
  bench.scene.material.reset();
  CHECK(refusal(bench) == "test: model \"tensor_mass\" needs a [material] section");
  Bench large;
  large.scene.deformation.of<ComplianceTolerance>().relative = 0;
  large.mesh = grid_block(test::lines_by(0, 0.001, 60), test::lines_by(-0.016, 0.008, 2),
                          test::lines_by(0, 0.001, 130));
  large.surface = boundary_surface(large.mesh);
  large.reachable.clear();
  for (int v = 0; v < static_cast<int>(large.surface.vertices.size()); ++v) large.reachable.push_back(v);
  large.fixed = fixed_vertices(large.scene, large.mesh);
  CHECK(refusal(large).find("reachable surface nodes would take") != std::string::npos);
}

TEST_CASE("a sphere on a block of tensor_mass: the force comes to that of quasi_static") {
  Simulation moving(test::shallow_block_scene("tensor_mass"), test::shallow_block()),
      still(test::shallow_block_scene("quasi_static"), test::shallow_block());
  const Vec3 pressed(0.001, 0.0035, 0.002);  // 1.5 mm deep at rest
  const ToolForce expected = still.step(pressed, kPeriod);
  REQUIRE(expected.force[1] > 0.1);
  ToolForce rendered;
  for (int i = 0; i < 60; ++i) {
    rendered = moving.step(pressed, kPeriod);
    CHECK_FALSE(rendered.flagged);
    CHECK(rendered.force.allFinite());
  }
  CHECK((rendered.force - expected.force).norm() < 0.01 * expected.force.norm());
  // And the tissue stands where that force holds it.
  CHECK(largest(moving.positions(), still.positions()) < 0.02 * 0.0015);
  test::lift_tools(moving);
  for (int i = 0; i < 60; ++i) moving.step(Vec3(0, 0.1, 0), kPeriod);
  CHECK(largest(moving.positions(), moving.rest()) < 1e-6);
}

TEST_CASE("tensor_mass: the tangent is the slope of the force over a period") {
  const auto rendered_at = [](const Vec3& last) {
    Simulation simulation(test::shallow_block_scene("tensor_mass"), test::shallow_block());
    for (int i = 0; i < 5; ++i)
      simulation.step(Vec3(0.001 + 0.0004 * i, 0.0045 - 0.0003 * i, 0.002), kPeriod);
    return simulation.step(last, kPeriod);
  };
  const Vec3 place(0.0031, 0.0031, 0.0021);
  const ToolForce rendered = rendered_at(place);
  REQUIRE(rendered.contacts > 0);
  REQUIRE_FALSE(rendered.flagged);
  constexpr double kStep = 1e-7;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 d = kStep * Vec3::Unit(axis);
    const Vec3 slope = (rendered_at(place + d).force - rendered_at(place - d).force) / (2 * kStep);
    CHECK((rendered.tangent.col(axis) - slope).norm() < 1e-4 * rendered.tangent.norm());
  }
}

TEST_CASE("tensor_mass: a step of the simulation does not allocate, and equal runs are equal") {
  Simulation one(test::shallow_block_scene("tensor_mass"), test::shallow_block()),
      two(test::shallow_block_scene("tensor_mass"), test::shallow_block());
  const auto step = [](Simulation& s, int i) { s.step(Vec3(0.0002 * i, 0.004, 0.002), kPeriod); };
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    for (int i = 0; i < 10; ++i) step(one, i);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
  for (int i = 0; i < 10; ++i) step(two, i);
  CHECK(one.state_hash() == two.state_hash());
}

TEST_CASE("two tools on tensor_mass come to rest as on quasi_static, and let go") {
  const auto two_tools = [](std::string_view model) {
    Scene scene = test::shallow_block_scene(model);
    scene.tools.push_back(scene.tools[0]);
    return scene;
  };
  Simulation moving(two_tools("tensor_mass"), test::shallow_block()),
      still(two_tools("quasi_static"), test::shallow_block());
  const std::vector<std::optional<ToolPose>> places{ToolPose(Vec3(-0.007, 0.004, 0)),
                                                    ToolPose(Vec3(0.006, 0.0035, 0.001))};
  const auto expected = still.step(test::inputs(places), kPeriod);
  for (int i = 0; i < 60; ++i) moving.step(test::inputs(places), kPeriod);
  const auto rendered = moving.step(test::inputs(places), kPeriod);
  for (std::size_t i = 0; i < 2; ++i)
    CHECK((rendered[i].force - expected[i].force).norm() < 0.01 * expected[i].force.norm());
  const std::vector<ToolInput> nowhere(2);
  for (int i = 0; i < 60; ++i) moving.step(nowhere, kPeriod);
  CHECK(largest(moving.positions(), moving.rest()) < 1e-6);
}

TEST_CASE(
    "tensor_mass: at rates near that of its sub-steps a tool at rest feels a steady force, that of statics") {
  Scene scene = test::scene_of({.young_modulus = 1e4, .poisson_ratio = 0.45},
                               {Vec3(-1, -1, -1), Vec3(1, -0.0149, 1)}, 0.004);
  const TetMesh mesh = grid_block(test::lines_by(-0.015, 0.005, 6), test::lines_by(-0.015, 0.005, 3),
                                  test::lines_by(-0.015, 0.005, 6));
  const Vec3 place(0.001, 0.001, 0.002);
  Simulation still(scene, mesh);
  const Vec3 expected = still.step(place, 1).force;
  scene.deformation.model = "tensor_mass";
  scene.deformation.of<RayleighDamping>().mass = 200;
  for (const double rate : {10000.0, 3000.0, 1500.0}) {
    CAPTURE(rate);
    scene.rate_hz = rate;
    Simulation moving(scene, mesh);
    const int down = static_cast<int>(0.05 * rate), steps = static_cast<int>(0.2 * rate);
    Vec3 force;
    for (int i = 1; i <= steps; ++i) {
      const double up = 0.005 * std::max(0.0, 1 - static_cast<double>(i) / down);
      force = moving.step(place + up * Vec3::UnitY(), 1 / rate).force;
      if (i > steps - 4) CHECK((force - expected).norm() < 0.01 * expected.norm());
    }
  }
}
