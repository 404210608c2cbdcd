#include "sim_server/sparse/elimination_tree.h"

#include <numeric>
#include <utility>

namespace palpate::sim {

std::vector<int> parents_of_columns(const MatrixGraph& graph) {
  const int n = graph.vertices();
  std::vector<int> parent(static_cast<std::size_t>(n), -1);
  std::vector<int> shortcut = parent;  // an ancestor among the rows so far, -1 at a root
  for (int row = 0; row < n; ++row) {
    for (const int neighbour : graph.neighbours_of(row)) {
      // The row becomes the parent of the root of each subtree that has an entry in it.
      for (int column = neighbour; column >= 0 && column < row;) {
        const int above = std::exchange(shortcut[column], row);
        if (above < 0) parent[column] = row;
        column = above;
      }
    }
  }
  return parent;
}

std::vector<int> postorder(std::span<const int> parent) {
  const auto n = static_cast<int>(parent.size());
  // A subtree takes consecutive places, the last for its root, then those of the last child, and so on.
  std::vector<int> size(parent.size(), 1);
  for (int v = 0; v < n; ++v) {
    if (parent[v] >= 0) size[parent[v]] += size[v];
  }
  std::vector<int> end(parent.size());  // of the free places of each subtree
  std::vector<int> order(parent.size());
  int roots_end = n;
  for (int v = n - 1; v >= 0; --v) {
    int& free_end = parent[v] < 0 ? roots_end : end[parent[v]];
    end[v] = free_end - 1;
    order[end[v]] = v;
    free_end -= size[v];
  }
  return order;
}

std::vector<int> renumbered_parents(std::span<const int> parent, std::span<const int> order) {
  std::vector<int> place(order.size()), result;
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<int>(k);
  for (const int vertex : order) result.push_back(parent[vertex] < 0 ? -1 : place[parent[vertex]]);
  return result;
}

namespace {

/// Last ancestor of a column, itself at first, among those linked so far; shortens the path to it.
int top_of(std::vector<int>& link, int column) {
  while (link[column] != column) column = link[column] = link[link[column]];
  return column;
}

}  // namespace

std::vector<int> column_counts(const MatrixGraph& graph, std::span<const int> parent) {
  const int n = graph.vertices();
  std::vector<int> first(parent.size());  // the first descendant of each column in postorder
  std::iota(first.begin(), first.end(), 0);
  for (int v = 0; v < n; ++v) {
    if (parent[v] >= 0 && first[v] < first[parent[v]]) first[parent[v]] = first[v];
  }
  // The columns with an entry in row i are a subtree with root i. Weights of 1 at its leaves, -1 at the
  // lowest common ancestor of each two consecutive leaves and -1 at the parent of i sum up, over the
  // descendants of a column, to 1 inside the subtree and 0 outside.
  std::vector<int> count(parent.size());  // weights of all rows, then their sums
  std::vector<int> last_entry(parent.size(), -1), last_leaf(parent.size(), -1);  // of each row
  std::vector<int> link(parent.size());
  std::iota(link.begin(), link.end(), 0);
  for (int column = 0; column < n; ++column) {
    if (first[column] == column) ++count[column];  // a row with nothing but the diagonal
    if (parent[column] >= 0) --count[parent[column]];
    for (const int row : graph.neighbours_of(column)) {
      if (row < column) continue;
      if (first[column] > last_entry[row]) {  // no descendant has an entry in the row: a leaf
        ++count[column];
        if (last_leaf[row] >= 0) --count[top_of(link, last_leaf[row])];
        last_leaf[row] = column;
      }
      last_entry[row] = column;
    }
    if (parent[column] >= 0) link[column] = parent[column];
  }
  for (int v = 0; v < n; ++v) {
    if (parent[v] >= 0) count[parent[v]] += count[v];
  }
  return count;
}

Elimination::Elimination(const MatrixGraph& graph, std::span<const int> given) {
  parent = parents_of_columns(graph.renumbered(given));
  const std::vector<int> post = postorder(parent);
  for (const int place : post) order.push_back(given[place]);
  parent = renumbered_parents(parent, post);
  counts = column_counts(graph.renumbered(order), parent);
}

double Elimination::multiplications() const {
  return std::accumulate(counts.begin(), counts.end(), 0.0, [](double sum, double n) { return sum + n * n; });
}

}  // namespace palpate::sim
