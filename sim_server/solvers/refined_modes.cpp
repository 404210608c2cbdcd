#include <Eigen/Eigenvalues>

#include "common/error.h"
#include "sim_server/solvers/vibration_modes.h"

namespace palpate::sim {

VibrationModes refined_modes(const FactoredMatrix& stiffness, const Eigen::VectorXd& masses,
                             Eigen::MatrixXd shapes) {
  constexpr int kMost = 8;
  constexpr double kSettled = 1e-3;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(shapes.cols());
  for (int k = 0; k < kMost; ++k) {
    const Eigen::MatrixXd forces = masses.asDiagonal() * shapes;
    const Eigen::MatrixXd next = stiffness.solve(forces);
    const Eigen::MatrixXd of_stiffness = next.transpose() * forces,
                          of_masses = next.transpose() * masses.asDiagonal() * next;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(
        0.5 * (of_stiffness + of_stiffness.transpose()), of_masses);
    if (small.info() != Eigen::Success) fail("modes of vibration cannot be found from those of another body");
    shapes.noalias() = next * small.eigenvectors();
    const double change =
        ((small.eigenvalues() - squares).array() / small.eigenvalues().array()).abs().maxCoeff();
    squares = small.eigenvalues();
    if (change < kSettled) break;
  }
  return {squares.cwiseSqrt(), std::move(shapes)};
}

}  // namespace palpate::sim
