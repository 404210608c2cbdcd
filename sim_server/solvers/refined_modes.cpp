#include "sim_server/solvers/vibration_modes.h"
#include "sim_server/sparse/dense_spectra.h"

namespace palpate::sim {

std::optional<VibrationModes> refined_modes(const FactoredMatrix& stiffness, const Eigen::VectorXd& masses,
                                            Eigen::MatrixXd shapes) {
  constexpr int kMost = 8;
  constexpr double kSettled = 1e-3;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(shapes.cols());
  for (int k = 0; k < kMost; ++k) {
    const Eigen::MatrixXd forces = masses.asDiagonal() * shapes;
    const Eigen::MatrixXd next = stiffness.solve(forces);
    const Eigen::MatrixXd of_stiffness = next.transpose() * forces,
                          of_masses = next.transpose() * masses.asDiagonal() * next;
    const auto small = symmetric_spectrum(0.5 * (of_stiffness + of_stiffness.transpose()), of_masses);
    if (!small || !(small->values.array() > 0).all()) return {};
    shapes.noalias() = next * small->vectors;
    const double change = ((small->values - squares).array() / small->values.array()).abs().maxCoeff();
    squares = small->values;
    if (change < kSettled) break;
  }
  return VibrationModes{squares.cwiseSqrt(), std::move(shapes)};
}

}  // namespace palpate::sim
