#include "common/contact/closed_contacts.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "tests/support/catch.h"

using namespace palpate;

namespace {

constexpr int kSize = 24, kContacts = 5;

/// A compliance, rows of B on two of its nodes each, and a curvature on four blocks, all random; the same
/// each time.
struct Problem {
  BoundedMatrix compliance{kSize, kSize};
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(kContacts, kSize),
                  curvature = Eigen::MatrixXd::Zero(kSize, kSize);
  ClosedContacts contacts{kSize, kContacts, 2 * kContacts, 16};
  WorkBudget work;

  /// `bend`: the largest eigenvalue of C S, roughly; above 1 what is free of the contacts gives way.
  explicit Problem(double bend) {
    std::srand(11);
    const Eigen::MatrixXd root = Eigen::MatrixXd::Random(kSize, kSize);
    compliance = root * root.transpose() + Eigen::MatrixXd::Identity(kSize, kSize);
    work.allow(1e9);
    contacts.start(compliance, kGive, work);
    for (int i = 0; i < 4; ++i) {
      const int at = 6 * i;
      const Mat3 half = Mat3::Random(), block = half + half.transpose();
      curvature.block<3, 3>(at, at) = block;
    }
    curvature *= bend / Eigen::MatrixXd(compliance * curvature).eigenvalues().cwiseAbs().maxCoeff();
    for (int i = 0; i < 4; ++i) contacts.add_curvature(6 * i, 6 * i, curvature.block<3, 3>(6 * i, 6 * i));
    for (int k = 0; k < kContacts; ++k) {
      const std::array<ClosedContacts::GapChange, 2> row{
          {{3 * k, Vec3::Random()}, {3 * k + 9, Vec3::Random()}}};
      for (const auto& entry : row) rows.block<1, 3>(k, entry.at) = entry.by.transpose();
      contacts.close(row);
    }
  }

  static constexpr double kGive = 0.01;
};

}  // namespace

TEST_CASE("closed contacts: forces and displacement as the whole linear system has them") {
  Problem problem(0.6);
  REQUIRE(problem.contacts.factor());
  // u = C (B^T lambda + S (u - u0)), B u + eps lambda = -gap: in one dense matrix, of Eigen.
  const Eigen::MatrixXd c = problem.compliance;
  const Eigen::VectorXd u0 = Eigen::VectorXd::Random(kSize), gap = Eigen::VectorXd::Random(kContacts);
  Eigen::MatrixXd all(kSize + kContacts, kSize + kContacts);
  all << Eigen::MatrixXd::Identity(kSize, kSize) - c * problem.curvature, -c * problem.rows.transpose(),
      problem.rows, Problem::kGive * Eigen::MatrixXd::Identity(kContacts, kContacts);
  Eigen::VectorXd right(kSize + kContacts);
  right << -c * problem.curvature * u0, -gap;
  const Eigen::VectorXd expected = all.partialPivLu().solve(right);

  Eigen::VectorXd forces = gap, moved(kSize), loads = Eigen::VectorXd::Zero(kSize);
  problem.contacts.find_forces(forces, loads);
  problem.contacts.press(forces, moved);
  moved -= u0;
  REQUIRE(problem.contacts.bend(moved, 1e-12));
  problem.contacts.curve(moved, loads);
  forces = gap;
  problem.contacts.find_forces(forces, loads);
  CHECK((moved + u0 - expected.head(kSize)).norm() < 1e-9 * expected.norm());
  CHECK((forces - expected.tail(kContacts)).norm() < 1e-9 * expected.norm());
}

TEST_CASE("closed contacts: where the energy falls, or work runs out, there is no displacement") {
  Eigen::VectorXd moved = Eigen::VectorXd::Random(kSize);
  Problem unstable(20);  // of both signs: some direction that the contacts leave free falls
  REQUIRE(unstable.contacts.factor());
  CHECK_FALSE(unstable.contacts.bend(moved, 1e-9));
  Problem stable(0.6);
  REQUIRE(stable.contacts.factor());
  stable.work.allow(100);
  moved.setRandom();
  CHECK_FALSE(stable.contacts.bend(moved, 1e-9));
}
