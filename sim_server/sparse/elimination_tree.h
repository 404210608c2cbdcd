#pragma once
#include <span>
#include <vector>

#include "sim_server/sparse/matrix_graph.h"

namespace palpate::sim {

/// Parent of each column in the elimination tree of a matrix: the first row below the diagonal in that column
/// of the Cholesky factor, -1 at a root. By path compression (Liu 1990, SIAM J. Matrix Anal. Appl. 11:134).
/// Nearly linear in the edges.
std::vector<int> parents_of_columns(const MatrixGraph& graph);

/// Vertex at each place of an order of a forest in which each vertex directly follows all of its descendants.
/// Children ascend. `parent`: larger than the vertex, or -1. Linear.
std::vector<int> postorder(std::span<const int> parent);

/// Parents of the same forest with vertex order[k] as number k.
std::vector<int> renumbered_parents(std::span<const int> parent, std::span<const int> order);

/// Entries in each column of the Cholesky factor, diagonal included, of a matrix whose columns are in a
/// postorder of its elimination tree. From the leaves of the rows' subtrees, without the pattern of the
/// factor (Gilbert, Ng and Peyton 1994, SIAM J. Matrix Anal. Appl. 15:1075). Nearly linear in the edges.
std::vector<int> column_counts(const MatrixGraph& graph, std::span<const int> parent);

/// Elimination of the vertices of a graph in a postorder of the elimination tree.
struct Elimination {
  /// Takes a postorder of the elimination tree of `given`, which leaves the fill as it is. `given`: the
  /// vertex at each place.
  Elimination(const MatrixGraph& graph, std::span<const int> given);

  /// Returns the work of a scalar Cholesky factorisation in this order: the sum of the squared column counts.
  double multiplications() const;

  std::vector<int> order;   ///< vertex at each place
  std::vector<int> parent;  ///< of each place, a place
  std::vector<int> counts;  ///< entries in the factor's column at each place
};

}  // namespace palpate::sim
