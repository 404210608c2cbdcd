#pragma once
/// An in-place direct solve for the small dense systems of a contact step that are not symmetric. Eigen's LU
/// factorisations allocate their permutations where the size is known only at run time; this does not. Its
/// `LLT` over an `Eigen::Ref`, for symmetric ones, needs no such replacement. Right-looking, by panels of 16
/// columns (Golub and Van Loan 2013, 3.4). Eigen's `PartialPivLU` takes 1.17, 1.07 and 1.09 times as long for
/// 9, 36 and 120 unknowns (`scripts/bench dense_system`).
#include <Eigen/Core>

namespace palpate {

/// Solves A X = B by Gaussian elimination with row pivoting, both overwritten. 0 when A is singular,
/// else the sign of its determinant. O(2/3 n^3 + 2 n^2 k).
int gauss_solve(Eigen::Ref<Eigen::MatrixXd> a, Eigen::Ref<Eigen::MatrixXd> b) noexcept;

}  // namespace palpate
