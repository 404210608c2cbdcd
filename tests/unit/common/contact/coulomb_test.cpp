#include "common/contact/coulomb.h"

#include <Eigen/Dense>
#include <algorithm>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;

namespace {

struct Problem {
  Eigen::MatrixXd g_matrix;
  Eigen::VectorXd g;
  double mu;
};

/// Like those of contact: n contacts that share an elastic body, mostly pressed, dragged one way. Not
/// symmetric by `skew`.
Problem random_problem(test::Random& random, int n, double skew) {
  Eigen::MatrixXd a(3 * n, 3 * n);
  for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = random.between(-1, 1);
  Problem problem{(a * a.transpose() + 0.3 * n * Eigen::MatrixXd::Identity(3 * n, 3 * n)) * 1e-3 / n,
                  Eigen::VectorXd(3 * n), random.between(0.05, 0.8)};
  for (Eigen::Index i = 0; i < a.size(); ++i) problem.g_matrix.data()[i] *= 1 + random.between(-skew, skew);
  const Vec3 drag = random.vector(1e-3);
  for (int k = 0; k < n; ++k) {
    problem.g[3 * k] = random.between(-1e-3, 2e-4);
    problem.g.segment<2>(3 * k + 1) = drag.head<2>() + random.vector(2e-4).head<2>();
  }
  return problem;
}

/// The same coefficient for all contacts.
Eigen::VectorXd friction_of(const Problem& p) {
  return Eigen::VectorXd::Constant(p.g.size() / 3, p.mu);
}

/// Signorini and Coulomb, written out: the largest violation, relative.
double violation(const Problem& p, const Eigen::VectorXd& z) {
  const Eigen::VectorXd w = p.g_matrix * z + p.g;
  const double force = z.cwiseAbs().maxCoeff() + 1e-300, length = p.g.cwiseAbs().maxCoeff();
  double worst = 0;
  for (Eigen::Index k = 0; k < z.size(); k += 3) {
    const double lambda = z[k], bound = p.mu * lambda;
    const Eigen::Vector2d beta = z.segment<2>(k + 1), slip = w.segment<2>(k + 1);
    worst = std::max({worst, -lambda / force, -w[k] / length, lambda * w[k] / (force * length)});
    worst = std::max(worst, (beta.norm() - bound) / force);
    // Dissipation is the largest there can be: beta . slip = -mu lambda |slip|.
    worst = std::max(worst, std::abs(beta.dot(slip) + bound * slip.norm()) / (force * length));
  }
  return worst;
}

}  // namespace

TEST_CASE("Coulomb: random problems are solved to the conditions of Signorini and Coulomb") {
  test::Random random(1);
  CoulombSolver solver(14);
  int sticks = 0, slips = 0, opens = 0;
  for (int i = 0; i < 400; ++i) {
    const Problem problem = random_problem(random, 1 + i % 14, i % 3 == 0 ? 0.02 : 0);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(problem.g.size());
    CAPTURE(i);
    REQUIRE(solver.solve(problem.g_matrix, problem.g, friction_of(problem), z));
    CHECK(violation(problem, z) < 1e-10);
    for (Eigen::Index k = 0; k < z.size(); k += 3) {
      const double fraction = z[k] > 0 ? z.segment<2>(k + 1).norm() / (problem.mu * z[k]) : -1;
      (fraction < 0 ? opens : fraction < 1 - 1e-9 ? sticks : slips) += 1;
    }
  }
  CHECK(std::min({sticks, slips, opens}) > 100);
}

TEST_CASE("Coulomb: the answer does not depend on where it starts, and is the same bit by bit") {
  test::Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Problem problem = random_problem(random, 8, 0);
    CoulombSolver solver(8), other(20);
    Eigen::VectorXd cold = Eigen::VectorXd::Zero(24), again = cold, warm(24);
    for (Eigen::Index k = 0; k < 24; ++k) warm[k] = random.between(-1, 1);
    REQUIRE(solver.solve(problem.g_matrix, problem.g, friction_of(problem), cold));
    REQUIRE(other.solve(problem.g_matrix, problem.g, friction_of(problem), again));
    REQUIRE(solver.solve(problem.g_matrix, problem.g, friction_of(problem), warm));
    CHECK(cold == again);
    CHECK((cold - warm).norm() < 1e-9 * cold.norm() + 1e-15);
  }
}

TEST_CASE("Coulomb: contacts that coincide, and a stuck body that cannot give, still have an answer") {
  // Three times the same contact on a body that only moves along its normal: rank one and a trace.
  Problem problem{1e-10 * Eigen::MatrixXd::Identity(9, 9), Eigen::VectorXd::Zero(9), 0.3};
  for (int r = 0; r < 9; r += 3) {
    for (int c = 0; c < 9; c += 3) problem.g_matrix(r, c) += 1e-3;
    problem.g.segment<3>(r) = Vec3(-1e-3, 1e-5, 0);
  }
  CoulombSolver solver(3);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(9);
  REQUIRE(solver.solve(problem.g_matrix, problem.g, friction_of(problem), z));
  CHECK(z[0] + z[3] + z[6] == Approx(1).epsilon(1e-6));
  CHECK(z[1] + z[4] + z[7] == Approx(-0.3).epsilon(1e-6));
}

TEST_CASE("Coulomb: the derivative of the solution agrees with finite differences") {
  test::Random random(3);
  CoulombSolver solver(6);
  for (int i = 0; i < 40; ++i) {
    Problem problem = random_problem(random, 6, i % 2 == 0 ? 0.02 : 0);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(18);
    REQUIRE(solver.solve(problem.g_matrix, problem.g, friction_of(problem), z));
    Eigen::Matrix<double, Eigen::Dynamic, 3> change(18, 3);
    for (Eigen::Index k = 0; k < change.size(); ++k) change.data()[k] = random.between(-1, 1);
    const Eigen::MatrixXd way = change;
    const Eigen::VectorXd w = problem.g_matrix * z + problem.g;
    REQUIRE(solver.differentiate(problem.g_matrix, z, w, friction_of(problem), change));
    constexpr double kStep = 1e-10;
    for (int c = 0; c < 3; ++c) {
      const auto at = [&](double step) {
        Eigen::VectorXd there = z;
        REQUIRE(solver.solve(problem.g_matrix, problem.g + step * way.col(c), friction_of(problem), there));
        return there;
      };
      const Eigen::VectorXd slope = (at(kStep) - at(-kStep)) / (2 * kStep);
      CHECK((slope - change.col(c)).norm() < 1e-3 * slope.norm());
    }
  }
}

TEST_CASE("Coulomb: where work ends, forces are in the friction cones, wherever they started") {
  test::Random random(6);
  CoulombSolver solver(6);
  WorkBudget work;
  solver.count_work(work);
  int unsolved = 0;
  for (int i = 0; i < 50; ++i) {
    const Problem problem = random_problem(random, 6, 0);
    Eigen::VectorXd z(problem.g.size());
    for (double& force : z) force = random.between(-1, 1);
    work.allow(1 + 200.0 * (i % 10));
    unsolved += solver.solve(problem.g_matrix, problem.g, friction_of(problem), z) ? 0 : 1;
    for (Eigen::Index k = 0; k < z.size(); k += 3) {
      CHECK(z[k] >= 0);
      CHECK(z.segment<2>(k + 1).norm() <= problem.mu * z[k] * (1 + 1e-12) + 1e-12);
    }
  }
  CHECK(unsolved > 10);
}

TEST_CASE("Coulomb: a solve does not allocate") {
  test::Random random(4);
  const Problem problem = random_problem(random, 10, 0);
  CoulombSolver solver(10);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(30);
  const Eigen::VectorXd friction = friction_of(problem);
  Eigen::Matrix<double, Eigen::Dynamic, 3> change = Eigen::MatrixXd::Ones(30, 3);
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    solver.solve(problem.g_matrix, problem.g, friction, z);
    solver.differentiate(problem.g_matrix, z, problem.g, friction, change);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
