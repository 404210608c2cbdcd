#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sim_server/solvers/vibration_modes.h"

namespace palpate::sim {

std::optional<VibrationModes> refined_modes(const FactoredMatrix& stiffness, const Eigen::VectorXd& masses,
                                            Eigen::MatrixXd shapes) {
  constexpr int kMost = 8;           // iterations of the subspace
  constexpr double kSettled = 1e-3;  // relative change of the squared frequencies
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(shapes.cols());
  for (int k = 0; k < kMost; ++k) {
    const Eigen::MatrixXd forces = masses.asDiagonal() * shapes;
    const Eigen::MatrixXd next = stiffness.solve(forces);
    const Eigen::MatrixXd of_stiffness = next.transpose() * forces,
                          of_masses = next.transpose() * masses.asDiagonal() * next;
    if (of_masses.llt().info() != Eigen::Success) return {};  // the eigen-solver does not look
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(
        0.5 * (of_stiffness + of_stiffness.transpose()), of_masses);
    if (small.info() != Eigen::Success || !(small.eigenvalues().array() > 0).all()) return {};
    shapes.noalias() = next * small.eigenvectors();
    const double change =
        ((small.eigenvalues() - squares).array() / small.eigenvalues().array()).abs().maxCoeff();
    squares = small.eigenvalues();
    if (change < kSettled) break;
  }
  return VibrationModes{squares.cwiseSqrt(), std::move(shapes)};
}

}  // namespace palpate::sim
