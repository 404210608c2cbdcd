#pragma once
#include <Eigen/Core>
#include <optional>

namespace palpate::sim {

/// A matrix (n x m) of low rank r as left^T right, in single precision.
struct LowRankFactors {
  Eigen::MatrixXf left;   ///< (r x n)
  Eigen::MatrixXf right;  ///< (r x m)
};

/// `matrix` (n x m) as such a product, by which it changes by no more than `tolerance` in Frobenius' norm,
/// and by the rounding of single precision; nothing where so many columns would have to be taken that
/// they would hold as many numbers as the matrix. Columns are taken out one by one, always the largest of
/// what is left (Gram and Schmidt, with pivots), and the product of those is cut to as few singular values as
/// the tolerance needs. Allocates. 6 n m r flops, and a singular value decomposition (r x m). Eigen's of the
/// whole matrix takes 5 times as long for 64 rows and columns, 10 times for 192 (`scripts/bench low_rank`).
std::optional<LowRankFactors> low_rank_factors(Eigen::MatrixXd matrix, double tolerance);

}  // namespace palpate::sim
