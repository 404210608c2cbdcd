#pragma once
#include <Eigen/Core>
#include <functional>
#include <span>

#include "sim_server/sparse/factored_matrix.h"
#include "sim_server/sparse/supernodal_pattern.h"

namespace palpate::sim {

/// The numbers of a Cholesky factor L of a given pattern, A = L L^T, in `double` or, at half the memory and
/// time, in `float`. Left-looking over dense blocks by BLAS (one thread a call): subtrees of the pattern on
/// all cores, then the supernodes above them by bands of rows on all cores. Bands do not depend on the number
/// of threads, nor do the bytes of L.
/// `scripts/bench cholesky` compares it with CHOLMOD's factor, which is GPL, has no `float` before version 5
/// and no blocks of the inverse, and whose bytes depend on the number of threads.
template <class Scalar>
class SupernodalFactor {
 public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  /// The pattern must outlive the factor.
  explicit SupernodalFactor(const SupernodalPattern& pattern);

  /// False where the matrix is not positive definite in these numbers: then L is of no use. Allocates
  /// scratch.
  bool factor(const SparseMatrix& lower);
  /// A^-1 B, (n x k). Several threads may ask at once. Allocates. 4 values k flops.
  Matrix solve(const Matrix& b) const;
  /// Fills `block` (m x m) with the rows and columns `unknowns` of A^-1, equal to its transpose. On all
  /// cores, the same bytes on any number of them; tells `progress` the share done, from the calling thread.
  /// Columns are taken in the order of elimination: a load's forward elimination touches only the supernodes
  /// above it in the tree, and by symmetry rows before it are not computed.
  void inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                     const std::function<void(double)>& progress) const;
  /// Computes the rows as `FactoredMatrix::inverse_rows`, with groups in the order of elimination. Memory: on
  /// each core the rows of a group, and 96 columns of all n.
  void inverse_rows(std::span<const int> unknowns, std::span<const int> begins,
                    const FactoredMatrix::TakeRows& take, const std::function<void(double)>& progress) const;

  std::size_t bytes() const { return values_.size() * sizeof(Scalar); }

 private:
  class InverseColumns;

  bool eliminate(int s, bool large, std::vector<int>& local);
  void assemble(int s, int from, int to, const std::vector<int>& local);
  void forward(Matrix& x) const;
  void backward(Matrix& x) const;
  Scalar* block(int s) { return values_.data() + pattern_->values_start[s]; }
  const Scalar* block(int s) const { return values_.data() + pattern_->values_start[s]; }

  const SupernodalPattern* pattern_;
  std::vector<Scalar> values_;
};

extern template class SupernodalFactor<double>;
extern template class SupernodalFactor<float>;

}  // namespace palpate::sim
