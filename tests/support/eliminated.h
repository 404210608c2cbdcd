#pragma once
#include <Eigen/Core>

#include "sim_server/sparse/matrix_graph.h"
#include "tests/support/random.h"

namespace palpate::test {

using Pattern = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Draws each edge of a graph with the given probability.
inline sim::MatrixGraph random_graph(int vertices, double probability, Random& random) {
  Pattern edges = Pattern::Constant(vertices, vertices, false);
  for (int i = 0; i < vertices; ++i) {
    for (int j = 0; j < i; ++j) edges(i, j) = edges(j, i) = random.between(0, 1) < probability;
  }
  sim::MatrixGraph graph;
  for (int i = 0; i < vertices; ++i) {
    for (int j = 0; j < vertices; ++j) {
      if (edges(i, j)) graph.neighbours.push_back(j);
    }
    graph.begin.push_back(graph.neighbours.size());
  }
  return graph;
}

/// Pattern of the Cholesky factor by elimination of one column after another, dense: each joins all rows that
/// it has below the diagonal. Diagonal included.
inline Pattern eliminated(const sim::MatrixGraph& graph) {
  const int n = graph.vertices();
  Pattern factor = Pattern::Identity(n, n);
  for (int column = 0; column < n; ++column) {
    for (const int row : graph.neighbours_of(column)) {
      if (row > column) factor(row, column) = true;
    }
  }
  for (int column = 0; column < n; ++column) {
    for (int a = column + 1; a < n; ++a) {
      for (int b = column + 1; b <= a; ++b) factor(a, b) |= factor(a, column) && factor(b, column);
    }
  }
  return factor;
}

}  // namespace palpate::test
