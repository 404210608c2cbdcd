#include "sim_server/low_rank/low_rank_factors.h"

#include <cmath>
#include <vector>

// The singular value decomposition of LAPACK. Eigen's takes 25 s to compile.
extern "C" void dgesdd_(const char* job, const int* rows, const int* columns, double* a, const int* rows_of_a,
                        double* singular, double* u, const int* rows_of_u, double* vt, const int* rows_of_vt,
                        double* work, const int* work_size, int* integers, int* info);

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

/// Singular value decomposition of a matrix with no more rows than columns: u diag(singular) vt.
struct Decomposition {
  Eigen::MatrixXd u;         // rows x rows
  Eigen::VectorXd singular;  // the largest first
  Eigen::MatrixXd vt;        // rows x columns
};

/// Returns nothing if LAPACK's iteration does not converge.
std::optional<Decomposition> decompose(Eigen::MatrixXd a) {
  const int rows = static_cast<int>(a.rows()), columns = static_cast<int>(a.cols());
  Decomposition found{Eigen::MatrixXd(rows, rows), Eigen::VectorXd(rows), Eigen::MatrixXd(rows, columns)};
  std::vector<int> integers(static_cast<std::size_t>(8 * rows));
  Eigen::VectorXd work(1);
  int info = 0;
  for (int size : {-1, 0}) {  // the first call asks for the size
    if (size == 0) {
      size = static_cast<int>(work[0]);
      work.resize(size);
    }
    dgesdd_("S", &rows, &columns, a.data(), &rows, found.singular.data(), found.u.data(), &rows,
            found.vt.data(), &rows, work.data(), &size, integers.data(), &info);
  }
  if (info != 0) return {};
  return found;
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
  const std::optional<Decomposition> svd = decompose(fractions.topRows(rank));
  if (!svd) return {};
  const Eigen::Index count = needed(svd->singular, std::sqrt(1 - kOfColumns * kOfColumns) * tolerance);
  const Eigen::VectorXd roots = svd->singular.head(count).cwiseSqrt();
  const Eigen::MatrixXd left = basis.leftCols(rank) * svd->u.leftCols(count) * roots.asDiagonal();
  return LowRankFactors{left.transpose().cast<float>(),
                        (roots.asDiagonal() * svd->vt.topRows(count)).cast<float>()};
}

}  // namespace palpate::sim
