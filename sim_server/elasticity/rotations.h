#pragma once
#include <span>

#include "common/types.h"

namespace palpate::sim {

/// The rotation nearest to each `F` (polar decomposition F = R S), det R = 1: by Newton's method (Higham
/// 1986, SIAM J. Sci. Stat. Comput. 7:1160), four at a time, or, where F is turned inside out or nearly flat,
/// by singular values. Each answer depends on its own F alone. A sixteenth to a twenty-fifth of the time of
/// Eigen's JacobiSVD, about a fifth of that of its closed form of eigenvalues, which knows no F that is
/// turned inside out (`scripts/bench rotations`).
void nearest_rotations(std::span<const Mat3> F, std::span<Mat3> R) noexcept;
/// Returns the nearest rotation of one matrix, at the cost of four.
Mat3 nearest_rotation(const Mat3& F) noexcept;

}  // namespace palpate::sim
