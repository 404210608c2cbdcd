// What every deformation model must do, row by row of the registry.
#include <Eigen/Eigenvalues>

#include "sim_server/deformation/deformation_models.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// A small block held at its bottom, with one model on it.
struct Bench {
  TetMesh mesh = grid_block({0, 0.01, 0.02, 0.03}, {0, 0.01, 0.02}, {0, 0.012, 0.025});
  Surface surface = boundary_surface(mesh);
  Scene scene = test::scene_of({8e3, 0.4, 1000}, {Vec3(-1, -1, -1), Vec3(1, 1, 0)}, 0.005);
  std::vector<int> fixed = fixed_vertices(scene, mesh), reachable;
  std::unique_ptr<DeformationModel> model;

  explicit Bench(const DeformationModelRow& row) {
    scene.rate_hz = 1000;  // steps below are of 1 ms
    for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) reachable.push_back(v);
    model = row.make({scene, mesh, surface, fixed, reachable, [](std::string_view, double) {}});
  }
};

}  // namespace

TEST_CASE("contract: every deformation model") {
  for (const DeformationModelRow& row : deformation_models()) {
    DYNAMIC_SECTION(row.name) {
      Bench bench(row);
      DeformationModel& model = *bench.model;
      const auto n = static_cast<int>(bench.surface.vertices.size());
      ContactPatch patch;
      patch.reserve(n, 1);
      model.compliance(bench.reachable, patch);
      const Eigen::MatrixXd c = patch.compliance.topLeftCorner(3 * n, 3 * n);

      SECTION("at rest without contact: free motion stays") {
        const std::span<const Vec3> free = model.free_motion(1e-3).positions;
        REQUIRE(static_cast<int>(free.size()) == n);
        for (int v = 0; v < n; ++v) CHECK(free[v] == bench.mesh.vertices[bench.surface.vertices[v]]);
      }
      SECTION("compliance is symmetric and positive semi-definite; tissue or tool gives way") {
        CHECK((c - c.transpose()).norm() == 0);
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(c);
        CHECK(eigen.eigenvalues().minCoeff() >= -1e-12 * std::max(1e-9, eigen.eigenvalues().maxCoeff()));
        CHECK((c.norm() > 0 || patch.tool_compliance > 0));
      }
      SECTION("loads move the surface by compliance times load, and it comes back without them") {
        std::vector<NodalLoad> loads{{0, Vec3(0.01, -0.02, 0.03)}, {n - 1, Vec3(-0.05, 0.01, -0.1)}};
        Eigen::VectorXd f = Eigen::VectorXd::Zero(3 * n);
        for (const NodalLoad& load : loads) f.segment<3>(3 * load.vertex) = load.force;
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
        const std::span<const Vec3> moved = model.apply(std::vector<NodalLoad>{{n - 1, Vec3(1, 1, 1)}});
        for (int v = 0; v < n; ++v) {
          const Vec3& rest = bench.mesh.vertices[bench.surface.vertices[v]];
          if (rest[2] == 0) CHECK(moved[v] == rest);
        }
      }
      SECTION("a step does not allocate") {
        const std::vector<NodalLoad> loads{{0, Vec3(0.01, 0, 0)}};
        std::size_t allocations = 1;
        {
          const test::AllocationGuard guard;
          model.free_motion(1e-3);
          model.compliance(bench.reachable, patch);
          model.apply(loads);
          allocations = guard.count();
        }
        if (row.name != "implicit") CHECK(allocations == 0);  // which factors matrices
      }
      SECTION("it says what it holds in memory") {
        CHECK_FALSE(model.memory().empty());
      }
    }
  }
}
