#pragma once
/// In-place direct solves for the small dense systems of a contact step. Eigen's own factorisations allocate
/// for matrices whose size is known only at run time; these do not.
#include <Eigen/Core>

namespace palpate {

/// Solves A X = B for symmetric positive definite A (n x n, lower triangle read and overwritten by its
/// Cholesky factor), B (n x k) overwritten by X. False when a pivot is not positive. O(n^3 / 3 + n^2 k).
bool cholesky_solve(Eigen::Ref<Eigen::MatrixXd> a, Eigen::Ref<Eigen::MatrixXd> b) noexcept;

/// Solves A X = B by Gaussian elimination with row pivoting, both overwritten. False when A is singular.
/// O(2/3 n^3 + 2 n^2 k).
bool gauss_solve(Eigen::Ref<Eigen::MatrixXd> a, Eigen::Ref<Eigen::MatrixXd> b) noexcept;

}  // namespace palpate
