#include "sim_server/sparse/matrix_graph.h"

#include <numeric>

namespace palpate::sim {

MatrixGraph MatrixGraph::of_blocks(const SparseMatrix& lower) {
  MatrixGraph graph;
  const auto nodes = static_cast<int>(lower.cols() / 3);
  const auto each_edge = [&](const auto& work) {
    for (int node = 0; node < nodes; ++node) {
      const int* const outer = lower.outerIndexPtr() + 3 * node;
      for (int k = outer[0]; k < outer[1]; k += 3) {
        const int other = lower.innerIndexPtr()[k] / 3;
        if (other > node) work(node, other);
      }
    }
  };
  graph.begin.resize(static_cast<std::size_t>(nodes) + 1, 0);
  each_edge([&](int a, int b) {
    ++graph.begin[a + 1];
    ++graph.begin[b + 1];
  });
  std::partial_sum(graph.begin.begin(), graph.begin.end(), graph.begin.begin());
  graph.neighbours.resize(graph.begin.back());
  std::vector<std::size_t> next = graph.begin;
  each_edge([&](int a, int b) {
    graph.neighbours[next[a]++] = b;
    graph.neighbours[next[b]++] = a;
  });
  return graph;
}

MatrixGraph MatrixGraph::renumbered(std::span<const int> order) const {
  MatrixGraph graph;
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[order[k]] = static_cast<int>(k);
    graph.begin.push_back(graph.begin.back() + neighbours_of(order[k]).size());
  }
  graph.neighbours.resize(neighbours.size());
  std::vector<std::size_t> next = graph.begin;
  for (std::size_t k = 0; k < order.size(); ++k) {  // k ascends, hence each list does
    for (const int other : neighbours_of(order[k]))
      graph.neighbours[next[place[other]]++] = static_cast<int>(k);
  }
  return graph;
}

}  // namespace palpate::sim
