#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "sim_server/sparse/elimination_tree.h"

namespace palpate::sim {

/// Pattern of a Cholesky factor as dense blocks: neighbouring columns, and the rows that any of them has.
struct Supernodes {
  int count() const { return static_cast<int>(first.size()) - 1; }
  std::span<const int> rows_of(int s) const {
    return std::span(rows).subspan(rows_start[s], rows_start[s + 1] - rows_start[s]);
  }

  std::vector<int> order;                  ///< vertex of the graph at each place
  std::vector<int> first{0};               ///< (count + 1) first column, a place
  std::vector<int> rows;                   ///< own columns, then rows below, ascending; list after list
  std::vector<std::size_t> rows_start{0};  ///< (count + 1)
};

/// Supernodes of the factor, in another postorder of the same tree. Columns of one structure are a supernode
/// (Liu, Ng and Peyton 1993, SIAM J. Matrix Anal. Appl. 14:242). From the leaves up, each one is merged with
/// the child of the most rows where that adds few zeros (Ashcraft and Grimes 1989, ACM Trans. Math. Softw.
/// 15:291): fewer, larger products by BLAS are faster. `width`: columns of the matrix that a vertex stands
/// for.
Supernodes find_supernodes(const MatrixGraph& graph, const Elimination& elimination, int width);

}  // namespace palpate::sim
