#include "sim_server/low_rank/low_rank_factors.h"

#include <Eigen/SVD>
#include <cmath>

namespace palpate::sim {
namespace {

constexpr double kOfColumns =
    0.5;  // of the tolerance, that the columns may leave; the singular values the rest

/// Returns how many singular values leave out no more than `omitted` in Frobenius' norm.
Eigen::Index needed(const Eigen::VectorXd& singular, double omitted) {
  Eigen::Index count = singular.size();
  double squares = 0;
  while (count > 0) {
    squares += singular[count - 1] * singular[count - 1];
    if (squares > omitted * omitted) break;
    --count;
  }
  return count;
}

}  // namespace

std::optional<LowRankFactors> low_rank_factors(Eigen::MatrixXd matrix, double tolerance) {
  const Eigen::Index n = matrix.rows(), m = matrix.cols(), most = n * m / (n + m);
  Eigen::MatrixXd basis(n, most), fractions(most, m);  // matrix = basis shares + what is left of it
  Eigen::VectorXd squares = matrix.colwise().squaredNorm();
  Eigen::Index rank = 0;
  const double may_leave = kOfColumns * tolerance;
  for (; !(squares.sum() <= may_leave * may_leave); ++rank) {  // what is not a number is no product
    if (rank == most) return {};
    Eigen::Index largest = 0;
    squares.maxCoeff(&largest);
    basis.col(rank) = matrix.col(largest).normalized();
    fractions.row(rank).noalias() = basis.col(rank).transpose() * matrix;
    matrix.noalias() -= basis.col(rank) * fractions.row(rank);
    squares = matrix.colwise().squaredNorm();
  }
  if (rank == 0) return LowRankFactors{Eigen::MatrixXf(0, n), Eigen::MatrixXf(0, m)};
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(fractions.topRows(rank),
                                           Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::Index count = needed(svd.singularValues(), std::sqrt(1 - kOfColumns * kOfColumns) * tolerance);
  const Eigen::VectorXd roots = svd.singularValues().head(count).cwiseSqrt();
  const Eigen::MatrixXd left = basis.leftCols(rank) * svd.matrixU().leftCols(count) * roots.asDiagonal(),
                        right = svd.matrixV().leftCols(count) * roots.asDiagonal();
  return LowRankFactors{left.transpose().cast<float>(), right.transpose().cast<float>()};
}

}  // namespace palpate::sim
