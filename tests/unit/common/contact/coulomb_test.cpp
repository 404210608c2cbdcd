#include "common/contact/coulomb.h"

#include <Eigen/Core>
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

/// Contacts that each have a place of friction of their own, with the same coefficient.
struct OfItsOwn {
  explicit OfItsOwn(const Problem& p)
      : mu(static_cast<std::size_t>(p.g.size() / 3), p.mu), order(p.g.size()) {
    const int n = static_cast<int>(mu.size());
    for (int k = 0; k < n; ++k) {
      shares.push_back({k, k, 1});
      order.indices()[3 * k] = k;
      for (int axis = 0; axis < 2; ++axis) order.indices()[3 * k + 1 + axis] = n + 2 * k + axis;
    }
  }
  FrictionPlaces places() const { return {shares, mu}; }
  std::vector<FrictionPlaces::Share> shares;
  std::vector<double> mu;
  Eigen::PermutationMatrix<Eigen::Dynamic> order;  // from contact by contact to normals first
};

/// A solver of problems contact by contact.
struct Solver : CoulombSolver {
  explicit Solver(int contacts) : CoulombSolver(contacts, contacts) {}
  bool solve(const Problem& p, Eigen::VectorXd& z) {
    const OfItsOwn own(p);
    Eigen::VectorXd ours = own.order * z;
    const bool solved = CoulombSolver::solve(own.order * p.g_matrix * own.order.transpose(), own.order * p.g,
                                             own.places(), ours);
    z = own.order.transpose() * ours;
    return solved;
  }
  bool differentiate(const Problem& p, const Eigen::VectorXd& z,
                     Eigen::Matrix<double, Eigen::Dynamic, 3>& change) {
    const OfItsOwn own(p);
    const Eigen::VectorXd w = p.g_matrix * z + p.g;
    Eigen::Matrix<double, Eigen::Dynamic, 3> ours = own.order * change;
    const bool done = CoulombSolver::differentiate(own.order * p.g_matrix * own.order.transpose(),
                                                   own.order * z, own.order * w, own.places(), ours);
    change = own.order.transpose() * ours;
    return done;
  }
};

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
  Solver solver(14);
  int sticks = 0, slips = 0, opens = 0;
  for (int i = 0; i < 400; ++i) {
    const Problem problem = random_problem(random, 1 + i % 14, i % 3 == 0 ? 0.02 : 0);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(problem.g.size());
    CAPTURE(i);
    REQUIRE(solver.solve(problem, z));
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
    Solver solver(8), other(20);
    Eigen::VectorXd cold = Eigen::VectorXd::Zero(24), again = cold, warm(24);
    for (Eigen::Index k = 0; k < 24; ++k) warm[k] = random.between(-1, 1);
    REQUIRE(solver.solve(problem, cold));
    REQUIRE(other.solve(problem, again));
    REQUIRE(solver.solve(problem, warm));
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
  Solver solver(3);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(9);
  REQUIRE(solver.solve(problem, z));
  CHECK(z[0] + z[3] + z[6] == Approx(1).epsilon(1e-6));
  CHECK(z[1] + z[4] + z[7] == Approx(-0.3).epsilon(1e-6));
}

TEST_CASE("Coulomb: the derivative of the solution agrees with finite differences") {
  test::Random random(3);
  Solver solver(6);
  for (int i = 0; i < 40; ++i) {
    Problem problem = random_problem(random, 6, i % 2 == 0 ? 0.02 : 0);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(18);
    REQUIRE(solver.solve(problem, z));
    Eigen::Matrix<double, Eigen::Dynamic, 3> change(18, 3);
    for (Eigen::Index k = 0; k < change.size(); ++k) change.data()[k] = random.between(-1, 1);
    const Eigen::MatrixXd way = change;
    REQUIRE(solver.differentiate(problem, z, change));
    constexpr double kStep = 1e-10;
    for (int c = 0; c < 3; ++c) {
      const auto at = [&](double step) {
        Eigen::VectorXd there = z;
        REQUIRE(solver.solve({problem.g_matrix, problem.g + step * way.col(c), problem.mu}, there));
        return there;
      };
      const Eigen::VectorXd slope = (at(kStep) - at(-kStep)) / (2 * kStep);
      CHECK((slope - change.col(c)).norm() < 1e-3 * slope.norm());
    }
  }
}

TEST_CASE("Coulomb: where work ends, forces are in the friction cones, wherever they started") {
  test::Random random(6);
  Solver solver(6);
  WorkBudget work;
  solver.count_work(work);
  int unsolved = 0;
  for (int i = 0; i < 50; ++i) {
    const Problem problem = random_problem(random, 6, 0);
    Eigen::VectorXd z(problem.g.size());
    for (double& force : z) force = random.between(-1, 1);
    work.allow(1 + 200.0 * (i % 10));
    unsolved += solver.solve(problem, z) ? 0 : 1;
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
  const OfItsOwn own(problem);
  CoulombSolver solver(10, 10);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(30);
  Eigen::Matrix<double, Eigen::Dynamic, 3> change = Eigen::MatrixXd::Ones(30, 3);
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    solver.solve(problem.g_matrix, problem.g, own.places(), z);
    solver.differentiate(problem.g_matrix, z, problem.g, own.places(), change);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}

TEST_CASE("Coulomb: contacts on the same places, more than these, obey the law of what presses there") {
  // Seven contacts on three nodes that give way alike: 7 + 6 rows of an operator of rank 9, and next to
  // nothing.
  test::Random random(5);
  for (int i = 0; i < 100; ++i) {
    CAPTURE(i);
    constexpr int kContacts = 7, kPlaces = 3;
    const double mu = random.between(0.1, 0.6);
    std::vector<FrictionPlaces::Share> shares;
    Eigen::MatrixXd at_nodes = Eigen::MatrixXd::Zero(kContacts + 2 * kPlaces, 3 * kPlaces);
    Eigen::VectorXd g(at_nodes.rows());
    for (int k = 0; k < kContacts; ++k) {
      Vec3 weights(random.between(0, 1), random.between(0, 1), random.between(0, 1));
      weights /= weights.sum();
      const Vec3 normal = (Vec3::UnitX() + random.vector(0.1)).normalized();
      for (int node = 0; node < kPlaces; ++node) {
        shares.push_back({k, node, weights[node] * normal[0]});
        at_nodes.block<1, 3>(k, 3 * node) = weights[node] * normal.transpose();
      }
      g[k] = random.between(-1e-3, -5e-4);
    }
    for (int node = 0; node < kPlaces; ++node) {
      for (int axis = 0; axis < 2; ++axis) at_nodes(kContacts + 2 * node + axis, 3 * node + 1 + axis) = 1;
      g.segment<2>(kContacts + 2 * node) = random.vector(3e-4).head<2>();
    }
    Eigen::MatrixXd compliance = 1e-3 * Eigen::MatrixXd::Identity(3 * kPlaces, 3 * kPlaces);
    for (int r = 0; r < kPlaces; ++r) {
      for (int c = 0; c < kPlaces; ++c) {
        if (r != c) compliance.block<3, 3>(3 * r, 3 * c) = 3e-4 * Mat3::Identity();
      }
    }
    Eigen::MatrixXd g_matrix = at_nodes * compliance * at_nodes.transpose();
    g_matrix.diagonal().array() += 1e-9;
    const std::vector<double> friction(kPlaces, mu);
    CoulombSolver solver(kContacts, kPlaces);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(g.size());
    REQUIRE(solver.solve(g_matrix, g, {shares, friction}, z));
    const Eigen::VectorXd w = g_matrix * z + g;
    Vec3 pressure = Vec3::Zero();
    for (const auto& s : shares) pressure[s.place] += s.share * z[s.contact];
    const double force = z.maxCoeff();
    REQUIRE(force > 0.1);
    for (int k = 0; k < kContacts; ++k) {
      CHECK(z[k] >= 0);
      CHECK(w[k] >= -1e-12);
      CHECK(z[k] * w[k] < 1e-10 * force * 1e-3);
    }
    for (int node = 0; node < kPlaces; ++node) {
      const Eigen::Vector2d beta = z.segment<2>(kContacts + 2 * node),
                            slip = w.segment<2>(kContacts + 2 * node);
      const double bound = mu * pressure[node];
      CHECK(beta.norm() <= bound * (1 + 1e-9));
      CHECK(std::abs(beta.dot(slip) + bound * slip.norm()) < 1e-10 * force * 1e-3);
    }
  }
}
