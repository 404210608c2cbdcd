#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "sim_server/sparse/stiffness_matrix.h"

namespace palpate::sim {

/// A^-1 of a symmetric positive definite matrix A (n x n), whoever factored A. Set-up and background threads
/// only.
class FactoredMatrix {
 public:
  FactoredMatrix() = default;
  virtual ~FactoredMatrix() = default;
  FactoredMatrix(const FactoredMatrix&) = default;
  FactoredMatrix& operator=(const FactoredMatrix&) = default;
  FactoredMatrix(FactoredMatrix&&) = default;
  FactoredMatrix& operator=(FactoredMatrix&&) = default;

  /// X = A^-1 B for dense B (n x k); allocates X.
  virtual Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const = 0;
  /// Fills `block` (m x m) with the rows and columns `unknowns` of A^-1, equal to its transpose; tells
  /// `progress` the share done, from the calling thread.
  virtual void inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                             const std::function<void(double)>& progress) const = 0;

  /// Rows of one group of unknowns, (its unknowns x m): those columns are there that belong to the groups
  /// `with`, of which `group` is one.
  using TakeRows = std::function<void(int group, std::span<const int> with, const Eigen::MatrixXd& rows)>;
  /// Computes that block without holding all of it. `unknowns` are in groups that start at `begins`, whose
  /// last entry is m. Calls `take` once for each group, from several threads at once, so that each pair of
  /// groups comes once. The arguments of one call do not depend on the number of threads. This default uses
  /// `inverse_block`: throws `Error` where there is no memory for all of the block.
  virtual void inverse_rows(std::span<const int> unknowns, std::span<const int> begins, const TakeRows& take,
                            const std::function<void(double)>& progress) const;
  /// Returns the memory of the factor that this process holds, bytes.
  virtual std::size_t bytes() const { return 0; }
};

/// Use of a factor; one that need not solve takes less memory.
enum class FactorUse { kInverse, kInverseAndSolve };

/// Factors the matrix whose lower triangle is given. `stored`: the unknowns of which `inverse_block` will be
/// asked. Throws `Error`, beginning with `where`, as `SparseCholesky`.
using MakeFactor = std::function<std::unique_ptr<FactoredMatrix>(
    const SparseMatrix& lower, std::span<const int> stored, FactorUse use, const std::string& where)>;

}  // namespace palpate::sim
