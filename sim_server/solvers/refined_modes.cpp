#include "sim_server/solvers/dense_modes.h"
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
    const Eigen::MatrixXd of_stiffness = next.transpose() * forces;
    const auto small = dense_modes(0.5 * (of_stiffness + of_stiffness.transpose()),
                                   next.transpose() * masses.asDiagonal() * next);
    if (!small || !(small->values.array() > 0).all()) return {};
    shapes.noalias() = next * small->shapes;
    const double change = ((small->values - squares).array() / small->values.array()).abs().maxCoeff();
    squares = small->values;
    if (change < kSettled) break;
  }
  return VibrationModes{squares.cwiseSqrt(), std::move(shapes)};
}

}  // namespace palpate::sim
