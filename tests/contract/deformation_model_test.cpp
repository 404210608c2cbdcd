// What every deformation model must do, row by row of the registry.

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/contract.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/model_bench.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

/// Two loads, turned as the scene is: large enough for the laws to differ.
std::vector<VertexLoad> two_loads(const ModelBench& bench, const Mat3& turn = Mat3::Identity()) {
  return {{bench.size() - 1, turn * Vec3(0.06, -0.03, -0.12)}, {bench.size() - 4, turn * Vec3(0, 0.05, 0.1)}};
}

/// Soon at rest.
const ModelBench::Setting kDamped{.rate_hz = 100, .rayleigh_mass = 200, .rayleigh_stiffness = 1e-3};

}  // namespace

CONTRACT("every deformation model", ModelCase, choice, model_cases()) {
  ModelBench bench(choice);
  DeformationModel& model = *bench.model;
  const auto n = static_cast<int>(bench.surface.vertices.size());
  ContactPatch patch;
  patch.reserve(n, 1);
  model.compliance(bench.reachable, patch);
  const Eigen::MatrixXd c = patch.compliance.topLeftCorner(3 * n, 3 * n);

  SECTION("at rest without contact: free motion stays") {
    const std::span<const Vec3> free = model.free_motion(1e-3).positions;
    REQUIRE(static_cast<int>(free.size()) == n);
    for (int v = 0; v < n; ++v) CHECK((free[v] - bench.rest(v)).norm() < 1e-17);
  }
  SECTION("compliance is symmetric and positive semi-definite; tissue or tool gives way") {
    CHECK((c - c.transpose()).norm() == 0);
    const Eigen::VectorXd values = test::eigenvalues(c);
    CHECK(values.minCoeff() >= -1e-12 * std::max(1e-9, values.maxCoeff()));
    CHECK((c.norm() > 0 || patch.tool_compliance > 0));
  }
  SECTION("loads move the surface by compliance times load, and it comes back without them") {
    std::vector<VertexLoad> loads{{0, Vec3(0.01, -0.02, 0.03)}, {n - 1, Vec3(-0.05, 0.01, -0.1)}};
    Eigen::VectorXd f = Eigen::VectorXd::Zero(3 * n);
    for (const VertexLoad& load : loads) f.segment<3>(3 * load.vertex) = load.force;
    const Eigen::VectorXd expected = c * f;
    const std::span<const Vec3> at = model.free_motion(1e-3).positions;
    const std::vector<Vec3> free(at.begin(), at.end());
    const std::span<const Vec3> moved = model.apply(loads);
    for (int v = 0; v < n; ++v) {
      CHECK((moved[v] - free[v] - expected.segment<3>(3 * v)).norm() < 1e-12 + 1e-9 * expected.norm());
    }
    const std::span<const Vec3> back = model.apply({});
    for (int v = 0; v < n; ++v) CHECK((back[v] - free[v]).norm() < 1e-12);
  }
  SECTION("fixed vertices never move") {
    const std::span<const Vec3> moved = model.apply(std::vector<VertexLoad>{{n - 1, Vec3(1, 1, 1)}});
    for (int v = 0; v < n; ++v) {
      const Vec3& rest = bench.mesh.vertices[bench.surface.vertices[v]];
      if (rest[2] == 0) CHECK(moved[v] == rest);
    }
  }
  SECTION("a step does not allocate") {
    const std::vector<VertexLoad> loads{{0, Vec3(0.01, 0, 0)}};
    std::size_t allocations = 1;
    {
      const test::AllocationGuard guard;
      model.free_motion(1e-3);
      model.compliance(bench.reachable, patch);
      model.apply(loads);
      allocations = guard.count();
    }
    if (!exempt(choice, "no allocation")) CHECK(allocations == 0);
  }
  SECTION("it says what it holds in memory") {
    CHECK_FALSE(model.memory().empty());
  }
}

CONTRACT("compliance is the slope of where loads lead, once all is said about the instant", ModelCase, choice,
         model_cases()) {
  const int held = held_until_fresh(choice);
  const auto pressed = [&](int axis, double by) {
    auto bench = std::make_unique<ModelBench>(choice, kDamped);
    std::vector<VertexLoad> loads = two_loads(*bench);
    for (int i = 0; i < 5 + held; ++i) bench->step(loads);
    loads[0].force[axis] += by;
    const std::span<const Vec3> moved = bench->instant(loads);
    return std::pair(std::vector(moved.begin(), moved.end()), std::move(bench));
  };
  const auto [positions, bench] = pressed(0, 0);
  const Eigen::MatrixXd c = bench->compliance(bench->reachable);
  const int vertex = two_loads(*bench)[0].vertex;
  constexpr double kStep = 1e-5;  // N
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Vec3> more = pressed(axis, kStep).first, less = pressed(axis, -kStep).first;
    const Eigen::VectorXd column = c.col(3 * vertex + axis);
    Eigen::VectorXd slope(column.size());
    for (int v = 0; v < bench->size(); ++v) slope.segment<3>(3 * v) = (more[v] - less[v]) / (2 * kStep);
    CAPTURE(axis, (slope - column).norm() / column.norm());
    CHECK((slope - column).norm() <= 1e-3 * column.norm());
  }
}

CONTRACT("the same scene elsewhere and turned gives the answers turned", ModelCase, choice, model_cases()) {
  Eigen::Isometry3d place(Eigen::Translation3d(0.3, -0.2, 0.1));
  if (!exempt(choice, "turning")) place.rotate(Eigen::AngleAxisd(2.2, Vec3(1, -2, 0.5).normalized()));
  const Mat3 turn = place.linear();
  ModelBench::Setting setting = kDamped;
  ModelBench at_tool(choice, setting);
  setting.place = place;
  ModelBench there(choice, setting);
  REQUIRE(at_tool.fixed == there.fixed);
  for (int step = 0; step < 6 + held_until_fresh(choice); ++step) {
    const std::vector<Vec3> a = at_tool.step(two_loads(at_tool)), b = there.step(two_loads(there, turn));
    double off = 0;
    for (int v = 0; v < at_tool.size(); ++v) off = std::max(off, (place * a[v] - b[v]).norm());
    CHECK(off <= 1e-8 * at_tool.largest_way(a) + 1e-15);
  }
  std::vector<int> free;  // how a held vertex gives way under a tool is nothing of physics
  std::ranges::copy_if(at_tool.reachable, std::back_inserter(free),
                       [&](int v) { return at_tool.rest(v)[2] > 0; });
  const Eigen::MatrixXd c = at_tool.compliance(free), d = there.compliance(free);
  Eigen::MatrixXd turned = c;
  for (Eigen::Index i = 0; i < c.rows(); i += 3) {
    for (Eigen::Index j = 0; j < c.cols(); j += 3)
      turned.block<3, 3>(i, j) = turn * c.block<3, 3>(i, j) * turn.transpose();
  }
  CHECK((turned - d).norm() <= 1e-8 * c.norm());
}
