#include "common/contact/dense_solve.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr Eigen::Index kPanel = 16;  // columns: a panel stays in the first cache

/// Swaps a row of `a` with the one below it that has the largest entry in column `j`, in `b` as well. The
/// sign of what this does to the determinant, with that of the pivot; 0 where there is no pivot.
int pivot(Eigen::Index j, Eigen::Ref<Eigen::MatrixXd> a, Eigen::Ref<Eigen::MatrixXd> b) noexcept {
  Eigen::Index row = 0;
  a.col(j).tail(a.rows() - j).cwiseAbs().maxCoeff(&row);
  row += j;
  if (!(std::abs(a(row, j)) > 0)) return 0;
  int sign = a(row, j) < 0 ? -1 : 1;
  if (row != j) {
    a.row(row).swap(a.row(j));
    b.row(row).swap(b.row(j));
    sign = -sign;
  }
  return sign;
}

}  // namespace

int gauss_solve(Eigen::Ref<Eigen::MatrixXd> a, Eigen::Ref<Eigen::MatrixXd> b) noexcept {
  const Eigen::Index n = a.rows();
  int sign = 1;
  for (Eigen::Index first = 0; first < n; first += kPanel) {
    const Eigen::Index width = std::min(kPanel, n - first), end = first + width, after = n - end;
    for (Eigen::Index j = first; j < end; ++j) {
      sign *= pivot(j, a, b);
      if (sign == 0) return 0;
      const Eigen::Index below = n - j - 1;
      a.col(j).tail(below) /= a(j, j);
      for (Eigen::Index k = j + 1; k < end; ++k) a.col(k).tail(below) -= a(j, k) * a.col(j).tail(below);
    }
    const auto corner = a.block(first, first, width, width).triangularView<Eigen::UnitLower>();
    const auto under = a.block(end, first, after, width);
    auto beside = a.block(first, end, width, after), loads = b.middleRows(first, width);
    corner.solveInPlace(beside);
    corner.solveInPlace(loads);
    a.bottomRightCorner(after, after).noalias() -= under * beside;
    b.bottomRows(after).noalias() -= under * loads;
  }
  a.triangularView<Eigen::Upper>().solveInPlace(b);
  return b.allFinite() ? sign : 0;
}

}  // namespace palpate
