#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "sim_server/sparse/stiffness_matrix.h"

namespace palpate::sim {

/// Pattern of a sparse Cholesky factor L of a matrix, before any number: the order of elimination and the
/// supernodes. Supernodes are neighbouring columns of L stored as one dense block (Ng and Peyton 1993, SIAM
/// J. Sci. Comput. 14:1034). Set-up only.
struct SupernodalPattern {
  /// Rows `from` to `to` of a supernode are columns of another, which takes its update from there down.
  struct Update {
    int source, from, to;
  };
  /// Supernodes `begin` to `end` - 1, which take updates from each other alone.
  struct Subtree {
    int begin, end;
  };

  /// Analyses a matrix whose lower triangle is in 3 x 3 blocks (`StiffnessMatrix`), by the graph of its
  /// nodes, as the three columns of a node have one structure. `countable` is false, and places are not
  /// found, where L has more than 2^31 entries. Throws `std::bad_alloc`.
  explicit SupernodalPattern(const SparseMatrix& lower);

  int supernodes() const { return static_cast<int>(first.size()) - 1; }
  int columns(int s) const { return first[s + 1] - first[s]; }
  /// Returns the rows of L that a supernode has: its own columns, then others below.
  std::span<const int> rows_of(int s) const {
    return std::span(rows).subspan(rows_start[s], rows_start[s + 1] - rows_start[s]);
  }
  std::span<const Update> updates_of(int s) const {
    return std::span(updates).subspan(updates_start[s], updates_start[s + 1] - updates_start[s]);
  }
  std::size_t values() const { return values_start.back(); }  ///< entries of all blocks
  std::size_t bytes() const;

  bool countable = true;
  std::vector<int> order;                 ///< (n) the unknown eliminated at each place
  std::vector<int> first;                 ///< (supernodes + 1) first column
  std::vector<int> rows;                  ///< one list after another
  std::vector<std::size_t> rows_start;    ///< (supernodes + 1)
  std::vector<std::size_t> values_start;  ///< (supernodes + 1) of blocks (rows x columns), by columns
  std::vector<Update> updates;            ///< ascending by source
  std::vector<std::size_t> updates_start;
  std::vector<int> place;  ///< of each entry of the matrix among the values; -1: not of the lower triangle
  std::vector<Subtree> subtrees;  ///< as many of like work as keep a few cores busy
  std::vector<int> top;           ///< the supernodes above them, ascending
  double multiplications = 0;     ///< that a factor takes

 private:
  void find_updates();
  void find_places(const SparseMatrix& lower);
  void cut_subtrees();
};

}  // namespace palpate::sim
