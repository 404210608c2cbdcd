#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "sim_server/sparse/stiffness_matrix.h"

namespace palpate::sim {

/// Undirected graph of a symmetric sparse matrix: a vertex for each row, an edge for each pair of entries off
/// the diagonal.
struct MatrixGraph {
  /// Graph of 3 x 3 blocks: a vertex for each node of `lower`, the lower triangle of a `StiffnessMatrix`.
  static MatrixGraph of_blocks(const SparseMatrix& lower);
  /// Graph with vertex order[k] as number k; neighbours ascend.
  MatrixGraph renumbered(std::span<const int> order) const;

  int vertices() const { return static_cast<int>(begin.size()) - 1; }
  std::span<const int> neighbours_of(int vertex) const {
    return std::span(neighbours).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
  }

  std::vector<std::size_t> begin{0};  ///< (vertices + 1)
  std::vector<int> neighbours;        ///< one list after another; each edge is in two lists
};

}  // namespace palpate::sim
