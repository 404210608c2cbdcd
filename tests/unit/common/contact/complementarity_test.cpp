#include "common/contact/complementarity.h"

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"

using namespace palpate;

namespace {

/// The solution by trying every active set: for a positive definite matrix there is exactly one.
Eigen::VectorXd by_enumeration(const Eigen::MatrixXd& g, const Eigen::VectorXd& gap) {
  const int n = static_cast<int>(gap.size());
  for (int set = 0; set < 1 << n; ++set) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < n; ++i) {
      if ((set >> i & 1) == 0) continue;
      a.row(i) = g.row(i);
      b[i] = -gap[i];
    }
    const Eigen::VectorXd lambda = test::solve_any(a, b), slack = g * lambda + gap;
    if (lambda.minCoeff() >= -1e-12 && slack.minCoeff() >= -1e-12) return lambda;
  }
  return {};
}

Eigen::MatrixXd random_positive_definite(test::Random& random, int n) {
  Eigen::MatrixXd a(n, n + 2);
  for (int i = 0; i < a.size(); ++i) a.data()[i] = random.between(-1, 1);
  return a * a.transpose() + 1e-3 * Eigen::MatrixXd::Identity(n, n);
}

}  // namespace

TEST_CASE("contact forces agree with the enumeration of all active sets") {
  test::Random random(3);
  ComplementaritySolver solver(8);
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 1 + trial % 8;
    const Eigen::MatrixXd g = random_positive_definite(random, n);
    Eigen::VectorXd gap(n), lambda(n);
    for (int i = 0; i < n; ++i) gap[i] = random.between(-1, 1);
    // From no guess, and from one that is wrong: what is in contact has a gap below 0.
    lambda.setZero();
    if (trial % 2 == 1) lambda = gap;
    REQUIRE(solver.solve(g, gap, lambda));
    REQUIRE((lambda - by_enumeration(g, gap)).cwiseAbs().maxCoeff() < 1e-8);
  }
}

TEST_CASE("large, nearly singular problems end feasible and complementary, without allocating") {
  test::Random random(4);
  constexpr int kSize = 80;
  ComplementaritySolver solver(kSize);
  // Rank 40 plus a whiff: as when many contacts share few nodes.
  Eigen::MatrixXd a(kSize, 40);
  for (int i = 0; i < a.size(); ++i) a.data()[i] = random.between(0, 1);
  const Eigen::MatrixXd g = a * a.transpose() + 1e-6 * Eigen::MatrixXd::Identity(kSize, kSize);
  Eigen::VectorXd gap(kSize), lambda = Eigen::VectorXd::Zero(kSize);
  for (int i = 0; i < kSize; ++i) gap[i] = random.between(-1, 0.5);
  bool solved = false;
  std::size_t allocations = 0;
  {
    const test::AllocationGuard guard;
    solved = solver.solve(g, gap, lambda);
    allocations = guard.count();
  }
  CHECK(solved);
  CHECK(allocations == 0);
  const Eigen::VectorXd slack = g * lambda + gap;
  CHECK(lambda.minCoeff() >= 0);
  CHECK(slack.minCoeff() > -1e-7);
  CHECK(std::abs(lambda.dot(slack)) < 1e-7 * lambda.norm());
}

TEST_CASE("a matrix that is not positive definite is refused with a harmless answer") {
  ComplementaritySolver solver(2);
  Eigen::Matrix2d g;
  g << -1, 0, 0, 1;
  Eigen::VectorXd gap = Eigen::Vector2d(-1, -1), lambda = Eigen::Vector2d::Zero();
  CHECK_FALSE(solver.solve(g, gap, lambda));
  CHECK(lambda.allFinite());
  CHECK(lambda.minCoeff() >= 0);
}
