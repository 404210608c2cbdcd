#pragma once
#include <Eigen/Core>

#ifdef PALPATE_WITH_CHOLMOD
#include "sim_server/sparse/blas.h"
#endif

namespace palpate::sim {

/// y = A x of a dense symmetric matrix of which the lower triangle is read: by BLAS, in half of Eigen's time
/// (0.079 and 0.164 ms of 1326 rows, AMD EPYC at 2.6 GHz), or, built with PALPATE_CHOLMOD=OFF, by Eigen. On
/// one thread, once a `SparseCholesky` was made. `y` is of the size of `x`.
inline void symmetric_product(const Eigen::MatrixXd& lower, const Eigen::VectorXd& x, Eigen::VectorXd& y) {
#ifdef PALPATE_WITH_CHOLMOD
  const int n = static_cast<int>(x.size()), next = 1;
  const double one = 1, zero = 0;
  if (n > 0) Blas<double>::symv("L", &n, &one, lower.data(), &n, x.data(), &next, &zero, y.data(), &next);
#else
  y.noalias() = lower.selfadjointView<Eigen::Lower>() * x;
#endif
}

}  // namespace palpate::sim
