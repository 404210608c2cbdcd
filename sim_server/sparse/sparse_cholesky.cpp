#include "sim_server/sparse/sparse_cholesky.h"

#include <atomic>
#include <limits>
#include <numeric>
#include <optional>

#include "common/error.h"
#include "common/log.h"
#include "sim_server/sparse/supernodal_factor.h"

namespace palpate::sim {

struct SparseCholesky::Factor {
  Factor(const SparseMatrix& lower, Precision wanted)
      : pattern(std::make_shared<const SupernodalPattern>(lower)), precision(wanted) {}

  std::shared_ptr<const SupernodalPattern> pattern;
  Precision precision;
  std::optional<SupernodalFactor<double>> fine;  // one of the two
  std::optional<SupernodalFactor<float>> rough;

  bool countable() const { return pattern->countable; }
  std::size_t bytes() const {
    const std::size_t number = precision == Precision::kSingle ? sizeof(float) : sizeof(double);
    return pattern->values() * number + pattern->bytes();
  }
  /// Returns what is taken besides while it is made.
  std::size_t work_bytes(const SparseMatrix&) const {
    return (pattern->subtrees.size() + 1) * pattern->order.size() * sizeof(int);
  }

  double multiplications() const { return pattern->multiplications; }
  bool factorize(const SparseMatrix& lower) {
    if (precision == Precision::kDouble) {
      if (!fine) fine.emplace(*pattern);
      return fine->factor(lower);
    }
    if (!rough) rough.emplace(*pattern);
    return rough->factor(lower);
  }

  /// Returns what double precision would take more than single.
  std::size_t more_bytes() const { return pattern->values() * (sizeof(double) - sizeof(float)); }
  /// Drops the factor and continues in this precision.
  void take(Precision other) {
    rough.reset();
    fine.reset();
    precision = other;
  }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const {
    return rough ? Eigen::MatrixXd(rough->solve(b.cast<float>()).cast<double>()) : fine->solve(b);
  }
  void inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                     const std::function<void(double)>& progress) const {
    if (rough) return rough->inverse_block(unknowns, block, progress);
    fine->inverse_block(unknowns, block, progress);
  }
  void inverse_rows(std::span<const int> unknowns, std::span<const int> begins, const TakeRows& take,
                    const std::function<void(double)>& progress) const {
    if (rough) return rough->inverse_rows(unknowns, begins, take, progress);
    fine->inverse_rows(unknowns, begins, take, progress);
  }
};

namespace {

constexpr double kSingular = 1e13;  // condition beyond which rounding has eaten the answer
constexpr double kRough = 1e-3;     // of a load: so much unbalanced is more than single precision may leave

/// True if it can go on in double precision; warns where that is for want of memory.
template <class Factor>
bool can_be_finer(const Factor& factor) {
  if (factor.precision == SparseCholesky::Precision::kDouble) return false;
  if (static_cast<double>(factor.more_bytes()) <= free_memory()) return true;
  static std::atomic_flag published;
  if (!published.test_and_set()) {
    log::warning(
        "a Cholesky factor would need {} more for double precision, which are not free: it stays in single",
        bytes_text(static_cast<double>(factor.more_bytes())));
  }
  return false;
}

/// Checks the memory between the analysis of the pattern and the numbers.
template <class Factor>
void require_room(const Factor& factor, const SparseMatrix& lower, double free, const std::string& where) {
  const std::string what = fmt::format("the Cholesky factor of {} unknowns", lower.rows());
  if (!factor.countable()) fail("{}: {} has more than 2^31 entries; take a coarser mesh", where, what);
  require_memory(static_cast<double>(factor.bytes() + factor.work_bytes(lower)), free, where, what,
                 "take a coarser mesh");
}

/// A load that no smooth motion balances.
Eigen::MatrixXd alternating(Eigen::Index n) {
  return Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return i % 2 == 0 ? 1.0 : -0.7; });
}

/// Returns the fraction of a load that an answer leaves.
double imbalance(const SparseMatrix& lower, const Eigen::MatrixXd& answer, const Eigen::MatrixXd& load) {
  return (load - lower.selfadjointView<Eigen::Lower>() * answer).norm() / load.norm();
}

/// A singular matrix can pass as positive definite by rounding; its answers are huge then.
bool nearly_singular(const SparseMatrix& lower, const Eigen::MatrixXd& answer) {
  const double largest = lower.diagonal().maxCoeff() * answer.cwiseAbs().maxCoeff();
  return !(largest < kSingular);
}

}  // namespace

SparseCholesky::SparseCholesky(const SparseMatrix& lower, const std::string& where, Precision precision,
                               double free)
    : factor_(std::make_unique<Factor>(lower, precision)) {
  if (lower.rows() == 0) return;
  const Eigen::MatrixXd load = alternating(lower.rows());
  Eigen::MatrixXd answer;
  bool definite = false;
  const auto factor = [&] {
    require_room(*factor_, lower, free, where);
    definite = factor_->factorize(lower);
    answer = definite ? solve(load) : load;
  };
  factor();
  const bool single = factor_->precision == Precision::kSingle;
  if (single && (!definite || !(imbalance(lower, answer, load) < kRough))) {
    factor_->take(Precision::kDouble);
    factor();
  }
  if (!definite || nearly_singular(lower, answer)) {
    fail(
        "{}: the stiffness matrix is singular: the fixed nodes do not hold the body; a [[fixed]] with three "
        "that are not in line would",
        where);
  }
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(const SparseCholesky& other)
    : FactoredMatrix(other),
      factor_(std::make_unique<Factor>(*other.factor_)),
      definite_(other.definite_),
      double_was_no_help_(other.double_was_no_help_) {}
SparseCholesky& SparseCholesky::operator=(const SparseCholesky& other) {
  return *this = SparseCholesky(other);
}
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

bool SparseCholesky::refactor(const SparseMatrix& lower) {
  definite_ = false;  // where this throws
  definite_ = lower.rows() == 0 || factor_->factorize(lower);
  if (definite_ || double_was_no_help_ || !can_be_finer(*factor_)) return definite_;
  factor_->take(Precision::kDouble);
  definite_ = factor_->factorize(lower);
  double_was_no_help_ = !definite_;
  if (!definite_) factor_->take(Precision::kSingle);
  return definite_;
}

void SparseCholesky::take_pattern(const SparseMatrix& lower) {
  factor_ = std::make_unique<Factor>(lower, factor_->precision);
  definite_ = false;
}

void SparseCholesky::check_precision(const SparseMatrix& lower) {
  if (!definite_ || !can_be_finer(*factor_)) return;
  const Eigen::MatrixXd load = alternating(lower.rows());
  if (imbalance(lower, solve(load), load) < kRough) return;
  factor_->take(Precision::kDouble);
  definite_ = false;
}

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& b) const {
  if (!definite_)
    return Eigen::MatrixXd::Constant(b.rows(), b.cols(), std::numeric_limits<double>::quiet_NaN());
  return b.rows() == 0 ? b : factor_->solve(b);
}

void SparseCholesky::inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                                   const std::function<void(double)>& progress) const {
  if (!definite_) {
    block.setConstant(std::numeric_limits<double>::quiet_NaN());
  } else if (!unknowns.empty()) {
    factor_->inverse_block(unknowns, block, progress);
  }
}

void SparseCholesky::inverse_rows(std::span<const int> unknowns, std::span<const int> begins,
                                  const TakeRows& take, const std::function<void(double)>& progress) const {
  if (definite_ && !unknowns.empty()) return factor_->inverse_rows(unknowns, begins, take, progress);
  FactoredMatrix::inverse_rows(unknowns, begins, take, progress);  // of what is not a number, or nothing
}

SparseCholesky::Precision SparseCholesky::precision() const {
  return factor_->precision;
}

std::size_t SparseCholesky::bytes() const {
  return factor_->bytes();
}

double SparseCholesky::multiplications() const {
  return factor_->multiplications();
}

}  // namespace palpate::sim
