#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/memory_budget.h"
#include "sim_server/sparse/factored_matrix.h"

namespace palpate::sim {

/// Sparse Cholesky factorisation of a symmetric positive definite matrix: a pattern (`SupernodalPattern`) and
/// numbers on all cores (`SupernodalFactor`). Set-up and background threads only.
class SparseCholesky final : public FactoredMatrix {
 public:
  /// Precision of the numbers of the factor. Single takes half the memory and time, and serves where the
  /// solution is corrected by its residual. Its answers are right to some 1e-6 of their size times the
  /// condition of the matrix. Double is taken instead, for good, as far as memory is free, in two cases. In
  /// the first matrix, more than a thousandth of a load remains; or a later matrix is positive definite only
  /// in double precision.
  enum class Precision { kDouble, kSingle };

  /// Factors the matrix whose lower triangle is given, in 3 x 3 blocks as `StiffnessMatrix` has them. Throws
  /// `Error`, beginning with `where`, when its factor would take more than `free` bytes (known from its
  /// pattern, before the numbers are allocated), when it is not positive definite, or singular but for
  /// rounding.
  SparseCholesky(const SparseMatrix& lower, const std::string& where,
                 Precision precision = Precision::kDouble, double free = free_memory());
  ~SparseCholesky() override;
  /// Copies the numbers; the pattern is shared.
  SparseCholesky(const SparseCholesky& other);
  SparseCholesky& operator=(const SparseCholesky& other);
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// Factors other values on the same pattern. False where the matrix is not positive definite: then the
  /// factor is of no use until the next one, and what it answers is not a number. Where it is not so in
  /// single precision, that may be for want of digits: double precision is tried, until that has not helped.
  bool refactor(const SparseMatrix& lower);

  /// The next `refactor` is of a matrix of this pattern; until then there is no factor.
  void take_pattern(const SparseMatrix& lower);

  /// Checks the factor of the matrix factored last. Where more than a thousandth of a load remains, the
  /// factor is of no use, and the next is in double precision. Cost of a solve.
  void check_precision(const SparseMatrix& lower);

  /// Several threads may ask at once.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const override;

  /// Computes the block on all cores, with the same bytes on any number of them. Any `unknowns`.
  void inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                     const std::function<void(double)>& progress) const override;
  void inverse_rows(std::span<const int> unknowns, std::span<const int> begins, const TakeRows& take,
                    const std::function<void(double)>& progress) const override;

  /// Returns the precision of the present factor.
  Precision precision() const;
  std::size_t bytes() const override;
  /// That one factorisation takes, counted from the pattern.
  double multiplications() const;

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
  bool definite_ = true;
  bool double_was_no_help_ = false;
};

}  // namespace palpate::sim
