#include "sim_server/elasticity/sparse_cholesky.h"

#include <limits>

#include "common/error.h"

#ifdef PALPATE_WITH_CHOLMOD
#include <Eigen/CholmodSupport>
// Present in every OpenBLAS, absent from other BLAS libraries: hence weak.
extern "C" void openblas_set_num_threads(int threads) __attribute__((weak));
// Likewise: in every OpenMP, which CHOLMOD may have been built with.
extern "C" void omp_set_max_active_levels(int levels) __attribute__((weak));
#else
#include <Eigen/SparseCholesky>
#endif

namespace palpate::sim {

struct SparseCholesky::Factor {
#ifdef PALPATE_WITH_CHOLMOD
  struct Llt : Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> {
    Llt() {
      if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);  // the same bits everywhere
      cholmod().print = 0;                                                   // errors are ours to word
      // Merge more columns than by default, twice as many zeros: fewer, larger products are quicker.
      for (auto& columns : cholmod().nrelax) columns *= 2;
      cholmod().zrelax[1] *= 2;
      cholmod().zrelax[2] *= 2;
    }
    cholmod_factor* factor() const { return m_cholmodFactor; }
    /// False where the factor has more entries than CHOLMOD's `int` counts. Else both below are known as soon
    /// as the pattern is.
    bool countable() const { return m_cholmodFactor != nullptr; }
    std::size_t bytes() const {
      return m_cholmodFactor->xsize * sizeof(double) +
             (m_cholmodFactor->ssize + 3 * m_cholmodFactor->n) * sizeof(int);
    }
    /// What is taken besides while it is made, but for a copy of the matrix.
    std::size_t work_bytes() const { return m_cholmodFactor->maxcsize * sizeof(double); }
  };
#else
  struct Llt : Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower> {
    bool countable() const { return true; }
    std::size_t bytes() const {
      const auto columns = static_cast<std::size_t>(m_matrix.outerSize());
      return static_cast<std::size_t>(m_matrix.outerIndexPtr()[columns]) * (sizeof(double) + sizeof(int)) +
             3 * columns * sizeof(int);
    }
    std::size_t work_bytes() const { return 0; }
  };
#endif
  Llt llt;

  /// Between the analysis of the pattern and the numbers.
  void require_room(const SparseMatrix& lower, double free, const std::string& where) const {
    const std::string what = fmt::format("the Cholesky factor of {} unknowns", lower.rows());
    if (!llt.countable()) fail("{}: {} has more than 2^31 entries; take a coarser mesh", where, what);
    const auto copy = static_cast<std::size_t>(lower.nonZeros()) * (sizeof(double) + sizeof(int));
    require_memory(static_cast<double>(llt.bytes() + llt.work_bytes() + copy), free, where, what,
                   "take a coarser mesh");
  }

  bool factorize(const SparseMatrix& lower) {
#ifdef PALPATE_WITH_CHOLMOD
    // CHOLMOD's own loops are short: its threads would wait for each other for longer than they work. The
    // setting is of the calling thread.
    if (omp_set_max_active_levels != nullptr) omp_set_max_active_levels(0);
#endif
    llt.factorize(lower);
    return llt.info() == Eigen::Success;
  }
};

namespace {

constexpr double kSingular = 1e13;  // condition beyond which rounding has eaten the answer

/// A load that no smooth motion balances.
Eigen::VectorXd alternating(Eigen::Index n) {
  return Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return i % 2 == 0 ? 1.0 : -0.7; });
}

/// A singular matrix can pass as positive definite by rounding; its answers are huge then.
bool nearly_singular(const SparseMatrix& lower, const Eigen::VectorXd& answer) {
  const double largest = lower.diagonal().maxCoeff() * answer.cwiseAbs().maxCoeff();
  return !(largest < kSingular);
}

}  // namespace

SparseCholesky::SparseCholesky(const SparseMatrix& lower, const std::string& where, double free)
    : factor_(std::make_unique<Factor>()) {
  factor_->llt.analyzePattern(lower);
  factor_->require_room(lower, free, where);
  if (!factor_->factorize(lower) || nearly_singular(lower, solve(alternating(lower.rows())))) {
    fail(
        "{}: the stiffness matrix is singular: the fixed nodes do not hold the body (three that are not in "
        "line would)",
        where);
  }
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

bool SparseCholesky::refactor(const SparseMatrix& lower) {
  return factor_->factorize(lower);
}

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& b) const {
#ifdef PALPATE_WITH_CHOLMOD
  constexpr double kNoAnswer = std::numeric_limits<double>::quiet_NaN();  // of a factor that is of no use
  // Eigen's would write to the workspace that belongs to the factor; this call has its own.
  cholmod_common workspace;
  cholmod_start(&workspace);
  workspace.print = 0;
  cholmod_dense rhs = Eigen::viewAsCholmod(b.const_cast_derived());
  cholmod_dense* solved = cholmod_solve(CHOLMOD_A, factor_->llt.factor(), &rhs, &workspace);
  Eigen::MatrixXd x = solved == nullptr ? Eigen::MatrixXd::Constant(b.rows(), b.cols(), kNoAnswer)
                                        : Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(
                                              static_cast<const double*>(solved->x), b.rows(), b.cols()));
  cholmod_free_dense(&solved, &workspace);
  cholmod_finish(&workspace);
  return x;
#else
  return factor_->llt.solve(b);
#endif
}

std::size_t SparseCholesky::bytes() const {
  return factor_->llt.bytes();
}

const char* SparseCholesky::library() {
#ifdef PALPATE_WITH_CHOLMOD
  return "CHOLMOD";
#else
  return "Eigen";
#endif
}

}  // namespace palpate::sim
