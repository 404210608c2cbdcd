#pragma once
#include <Eigen/SparseCore>
#include <span>
#include <vector>

#include "common/types.h"

namespace palpate::sim {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Which displacements are unknown: three per free node, in node order; a fixed node has none.
struct FreeDofs {
  std::vector<int> first;  ///< (n nodes) index of the x displacement, or -1 where the node is fixed
  int count = 0;           ///< number of unknowns

  FreeDofs(int nodes, const std::vector<int>& fixed);
};

/// A symmetric sparse matrix of 3 x 3 blocks over free nodes, of which the lower triangle is kept: one
/// pattern, filled again and again without a search. Blocks on the diagonal are kept whole; what reads the
/// lower triangle passes over the rest.
class StiffnessMatrix {
 public:
  /// `groups`: lists of nodes, one after the other, whose nodes all meet each other; group g is from first[g]
  /// to first[g + 1] - 1.
  StiffnessMatrix(const FreeDofs& dofs, std::span<const int> groups, std::span<const int> first);

  void set_zero() noexcept;
  /// Adds the block of rows of node `i` and columns of node `j`; also stands for the one of j and i. Each
  /// pair once. Nothing where one is fixed.
  void add(int i, int j, const Mat3& block) noexcept;
  /// Adds `factor` per_node[i] to the diagonal entries of each free node i.
  void add_to_diagonal(std::span<const double> per_node, double factor) noexcept;

  /// Rows and columns by `FreeDofs`; only the lower triangle is to be read.
  const SparseMatrix& lower() const { return matrix_; }
  SparseMatrix& lower() { return matrix_; }
  std::size_t bytes() const;

 private:
  std::vector<int> block_;  // of each node: its number among the free ones; -1: fixed
  SparseMatrix matrix_;
};

}  // namespace palpate::sim
