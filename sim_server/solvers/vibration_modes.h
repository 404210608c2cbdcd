#pragma once
#include <optional>
#include <span>
#include <string>

#include "sim_server/sparse/factored_matrix.h"

namespace palpate::sim {

/// Modes of vibration of a body.
struct VibrationModes {
  Eigen::VectorXd frequencies;  ///< (k) angular, rad/s, ascending
  Eigen::MatrixXd shapes;       ///< (unknowns x k), 1/sqrt(kg): of unit mass, phi^T M phi = 1
  std::string note = {};        ///< where they are from, if not computed now: "from the set-up cache, ..."
};

/// The `count` lowest modes of K phi = w^2 M phi, by the implicitly restarted Lanczos method (Spectra) on
/// M^1/2 K^-1 M^1/2, to 1e-10 of w^2. `stiffness`: the factor of K. `masses`: the diagonal of M, kg > 0, by
/// unknowns. Starts from the same vector every time. Throws `Error`, beginning with `where`, where `count` is
/// not below the number of unknowns. Cost: some 2 to 4 solves a mode. Allocates 2 `count` vectors.
VibrationModes vibration_modes(const FactoredMatrix& stiffness, const Eigen::VectorXd& masses, int count,
                               const std::string& where);

/// Returns the modes from shapes of a body that was almost this one (unknowns x k), by iterations of that
/// subspace (Bathe and Wilson 1972, Int. J. Numer. Methods Eng. 6:213) until none of its w^2 changes by more
/// than 1e-3, 8 at most. Whatever is left over, M-orthonormal shapes that are followed as if they were modes.
/// k solves at once for an iteration; Lanczos' method, which starts from one vector, has no use for the
/// shapes. Nothing where these do not span k dimensions, as what some moved alone is cut away.
std::optional<VibrationModes> refined_modes(const FactoredMatrix& stiffness, const Eigen::VectorXd& masses,
                                            Eigen::MatrixXd shapes);

}  // namespace palpate::sim
