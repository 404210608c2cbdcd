#include "common/contact/dense_solve.h"

#include <cmath>

namespace palpate {

int gauss_solve(Eigen::Ref<Eigen::MatrixXd> a, Eigen::Ref<Eigen::MatrixXd> b) noexcept {
  const Eigen::Index n = a.rows();
  int sign = 1;
  for (Eigen::Index j = 0; j < n; ++j) {
    Eigen::Index pivot = 0;
    a.col(j).tail(n - j).cwiseAbs().maxCoeff(&pivot);
    pivot += j;
    if (!(std::abs(a(pivot, j)) > 0)) return 0;
    if (pivot != j) {
      a.row(pivot).swap(a.row(j));
      b.row(pivot).swap(b.row(j));
      sign = -sign;
    }
    if (a(j, j) < 0) sign = -sign;
    const Eigen::Index below = n - j - 1;
    a.col(j).tail(below) /= a(j, j);
    for (Eigen::Index k = j + 1; k < n; ++k) a.col(k).tail(below) -= a(j, k) * a.col(j).tail(below);
    for (Eigen::Index c = 0; c < b.cols(); ++c) b.col(c).tail(below) -= b(j, c) * a.col(j).tail(below);
  }
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    for (Eigen::Index j = n - 1; j >= 0; --j) {
      b(j, c) /= a(j, j);
      b.col(c).head(j) -= b(j, c) * a.col(j).head(j);
    }
  }
  return b.allFinite() ? sign : 0;
}

}  // namespace palpate
