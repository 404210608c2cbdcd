#include "tests/support/dense_algebra.h"

#include <Eigen/Dense>

namespace palpate::test {

Quat turn_between(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to);
}

Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.llt().solve(b);
}

bool is_definite(const Eigen::MatrixXd& a) {
  return a.llt().info() == Eigen::Success;
}

Eigen::MatrixXd solve_any(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXcd solve_any(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXd solve_least(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::VectorXd solution_at(double t, const Eigen::MatrixXd& a, const Eigen::VectorXd& x) {
  const Eigen::EigenSolver<Eigen::MatrixXd> eigen(a);
  const Eigen::VectorXcd shares = eigen.eigenvectors().partialPivLu().solve(x.cast<std::complex<double>>()),
                         grown = (eigen.eigenvalues() * t).array().exp() * shares.array();
  return (eigen.eigenvectors() * grown).real();
}

Eigen::VectorXd singular_values(const Eigen::MatrixXd& a) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(a).singularValues();
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& a) {
  return a.householderQr().householderQ() * Eigen::MatrixXd::Identity(a.rows(), a.cols());
}

DenseModes dense_modes(const Eigen::MatrixXd& stiffness, const Eigen::VectorXd& masses) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      stiffness, Eigen::MatrixXd(masses.asDiagonal()));
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace palpate::test
