#pragma once
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/types.h"

namespace palpate::sim {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Axes along which a node is held: bit 0 is x, 1 y, 2 z.
using HeldAxes = std::uint8_t;
constexpr HeldAxes kAllAxes = 7;

/// Which displacements are unknown: three per node that is not held altogether, in node order. Those along an
/// axis that is held are unknowns that are always 0.
struct FreeDofs {
  std::vector<int> first;      ///< (n nodes) index of the x displacement, or -1 where the node is fixed
  std::vector<HeldAxes> held;  ///< (n nodes)
  int count = 0;               ///< number of unknowns

  /// Numbers the unknowns of nodes of which some are fixed.
  FreeDofs(int nodes, const std::vector<int>& fixed);
  explicit FreeDofs(std::vector<HeldAxes> held_axes);

  /// Sets to 0 what is held along single axes; `v` by unknowns.
  void hold(Eigen::VectorXd& v) const noexcept;

 private:
  void number();
};

/// A symmetric sparse matrix of 3 x 3 blocks over free nodes, of which the lower triangle is kept: one
/// pattern, filled again and again. Blocks on the diagonal are kept whole; what reads the lower triangle
/// passes over the rest.
class StiffnessMatrix {
 public:
  /// `groups`: lists of nodes, one after the other, whose nodes all meet each other; group g is from first[g]
  /// to first[g + 1] - 1.
  StiffnessMatrix(const FreeDofs& dofs, std::span<const int> groups, std::span<const int> first);

  void set_zero() noexcept;
  /// Puts `value` on the diagonal where that is 0: where a node is held along an axis, or is of no element,
  /// so that its row and column are 0. After all is added.
  void close_empty(double value) noexcept;
  /// Adds the block of rows of node `i` and columns of node `j`; also stands for the one of j and i. Each
  /// pair once. Nothing where one is fixed. O(blocks in the column).
  void add(int i, int j, const Mat3& block) noexcept;
  /// Threads may add at once, each the blocks of its own group.
  static constexpr std::size_t kGroups = 4;
  /// True if the block that `add` would change belongs to `group`.
  bool is_of_group(std::size_t group, int i, int j) const noexcept {
    return static_cast<std::size_t>(std::min(block_[i], block_[j])) % kGroups == group;
  }
  /// Adds `factor` per_node[i] to the diagonal entries of each free node i.
  void add_to_diagonal(std::span<const double> per_node, double factor) noexcept;

  /// A X for dense X (n x k), all k at once.
  Eigen::MatrixXd times(const Eigen::MatrixXd& x) const;

  /// Rows and columns by `FreeDofs`; only the lower triangle is to be read.
  const SparseMatrix& lower() const { return matrix_; }
  SparseMatrix& lower() { return matrix_; }
  std::size_t bytes() const;

 private:
  void add_to(int i, int j, const Mat3& block) noexcept;

  std::vector<int> block_;      // of each node: its number among the free ones; -1: fixed
  std::vector<HeldAxes> held_;  // of each node
  bool partly_held_ = false;    // any along some axes only
  // Of block columns, one after another: the block rows from the diagonal down. Block k begins in column
  // c at entry 9 rows_begin_[c] + 3 (k - rows_begin_[c]).
  std::vector<int> rows_, rows_start_{0};
  SparseMatrix matrix_;
};

}  // namespace palpate::sim
