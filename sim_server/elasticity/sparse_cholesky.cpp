#include "sim_server/elasticity/sparse_cholesky.h"

#include "common/error.h"

#ifdef PALPATE_WITH_CHOLMOD
#include <Eigen/CholmodSupport>
// Present in every OpenBLAS, absent from other BLAS libraries: hence weak.
extern "C" void openblas_set_num_threads(int threads) __attribute__((weak));
#else
#include <Eigen/SparseCholesky>
#endif

namespace palpate::sim {

struct SparseCholesky::Factor {
#ifdef PALPATE_WITH_CHOLMOD
  Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> llt;
#else
  Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower> llt;
#endif
};

SparseCholesky::SparseCholesky(const SparseMatrix& lower) : factor_(std::make_unique<Factor>()) {
#ifdef PALPATE_WITH_CHOLMOD
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);  // the same bits on every machine
  factor_->llt.cholmod().print = 0;  // errors are ours to word
#endif
  factor_->llt.compute(lower);
  if (factor_->llt.info() != Eigen::Success) {
    fail("the stiffness matrix is not positive definite: too few fixed nodes to hold the body, or a degenerate mesh");
  }
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& b) const {
  return factor_->llt.solve(b);
}

const char* SparseCholesky::library() {
#ifdef PALPATE_WITH_CHOLMOD
  return "CHOLMOD";
#else
  return "Eigen";
#endif
}

}  // namespace palpate::sim
