#pragma once
#include <Eigen/Core>
#include <optional>

namespace palpate::sim {

/// The n solutions of K phi = lambda M phi.
struct DenseModes {
  Eigen::VectorXd values;  ///< lambda, the smallest first
  Eigen::MatrixXd shapes;  ///< phi in columns (n x n): phi^T M phi is the unit matrix
};

/// Solves K phi = lambda M phi for symmetric K and M by LAPACK (dsygv), of whose lower triangles it uses the
/// numbers; Eigen's solver takes 25 s to compile. Returns nothing if M is not positive definite, or the
/// iteration does not converge. Allocates.
std::optional<DenseModes> dense_modes(Eigen::MatrixXd stiffness, Eigen::MatrixXd masses);

}  // namespace palpate::sim
