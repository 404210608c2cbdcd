#include "common/error.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/sparse/sparse_cholesky.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/stiffness.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// A block of irregular tetrahedra: inner vertices shaken, boundary planes kept.
TetMesh shaken_block() {
  TetMesh mesh = grid_block({0, 0.3, 0.7, 1}, {0, 0.4, 0.8, 1.1}, {0, 0.5, 0.9, 1.3});
  test::Random random(7);
  for (Vec3& x : mesh.vertices) {
    const bool inner = x[0] > 0 && x[0] < 1 && x[1] > 0 && x[1] < 1.1 && x[2] > 0 && x[2] < 1.3;
    if (inner) x += random.vector(0.05);
  }
  return mesh;
}

bool is_inner(const Vec3& x) {
  constexpr double kEdge = 1e-12;
  return x.minCoeff() > kEdge && (Vec3(1, 1.1, 1.3) - x).minCoeff() > kEdge;
}

constexpr std::array kElements{ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic};

SparseCholesky factor_of(const Solid& solid, const FreeDofs& dofs) {
  StiffnessMatrix k = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), k);
  return {k.lower(), "test"};
}

}  // namespace

TEST_CASE("patch test: prescribing a linear field on the boundary gives it inside, to 1e-12") {
  const ElementKind element = GENERATE(from_range(kElements));
  const Solid solid(with_nodes(shaken_block(), element), {1e4, 0.45, 1000, ElasticLaw::kLinear, element});
  const int n = solid.nodes();
  const Eigen::MatrixXd k = test::dense_stiffness(solid, FreeDofs(n, {}));
  Mat3 gradient;
  gradient << 0.01, 0.003, -0.002, 0.004, -0.02, 0.001, 0.005, -0.001, 0.015;
  Eigen::VectorXd u(3 * n);
  std::vector<int> inner, outer;
  for (int v = 0; v < n; ++v) {
    const Vec3& x = solid.rest()[v];
    u.segment<3>(3 * v) = gradient * x;
    (is_inner(x) ? inner : outer).push_back(v);
  }
  REQUIRE(std::ranges::count_if(inner, [](int v) { return v < 64; }) == 8);
  // Solve K_ii u_i = -K_io u_o with the program's own dofs and Cholesky.
  const FreeDofs dofs(n, outer);
  const SparseCholesky factor = factor_of(solid, dofs);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(dofs.count);
  for (const int i : inner) {
    for (const int o : outer) {
      load.segment<3>(dofs.first[i]) -= k.block<3, 3>(3 * i, 3 * o) * u.segment<3>(3 * o);
    }
  }
  const Eigen::VectorXd solved = factor.solve(load);
  for (const int i : inner) {
    CHECK((solved.segment<3>(dofs.first[i]) - u.segment<3>(3 * i)).norm() < 1e-12 * u.norm());
  }
}

TEST_CASE("the stiffness is symmetric, positive, blind to rigid motion, energy is that of uniform strain") {
  const ElementKind element = GENERATE(from_range(kElements));
  const Material material{1e4, 0.3, 1000, ElasticLaw::kLinear, element};
  const Solid solid(with_nodes(shaken_block(), element), material);
  const int n = solid.nodes();
  const Eigen::MatrixXd k = test::dense_stiffness(solid, FreeDofs(n, {}));
  Eigen::VectorXd rotation(3 * n), stretch(3 * n);
  for (int v = 0; v < n; ++v) {
    rotation.segment<3>(3 * v) = Vec3(1, 2, 3).cross(solid.rest()[v]);
    stretch.segment<3>(3 * v) = Vec3(0.01 * solid.rest()[v][0], 0, 0);
  }
  CHECK((k * rotation).norm() < 1e-12 * k.norm() * rotation.norm());
  // Uniaxial strain e: energy = volume (lambda + 2 mu) e^2 / 2.
  const double expected = 1 * 1.1 * 1.3 * (material.lame_lambda() + 2 * material.lame_mu()) * 1e-4 / 2;
  CHECK(0.5 * stretch.dot(k * stretch) == Approx(expected).epsilon(1e-12));
}

TEST_CASE("a body that nothing holds is refused") {
  const Solid solid(shaken_block(), {});
  CHECK_THROWS_AS(factor_of(solid, FreeDofs(solid.nodes(), {0})), Error);
}
