#include "sim_server/sparse/supernodes.h"

#include <algorithm>
#include <array>
#include <utility>

namespace palpate::sim {
namespace {

/// A supernode of up to so many columns may have up to such a share of zeros: twice the columns and zeros
/// that CHOLMOD takes by default (Chen et al. 2008, ACM Trans. Math. Softw. 35:22).
struct Allowance {
  double columns, zeros;
};
// As above; the last one for all larger supernodes.
constexpr std::array kAllowances{Allowance{8, 1}, Allowance{32, 0.8}, Allowance{96, 0.2},
                                 Allowance{1e9, 0.1}};

/// Part of the elimination tree that becomes one supernode.
struct Part {
  int first, last;       // columns, in the postorder of the tree
  int parent;            // part above it, -1 at a root
  int merged_into;       // part above it, -1: itself a supernode
  double columns, rows;  // with those merged into it
  double zeros;          // entries of the dense block that the factor does not have
};

double entries(double columns, double rows) {
  return columns * rows - columns * (columns - 1) / 2;
}

/// Columns of one structure.
std::vector<Part> fundamental_parts(const Elimination& tree) {
  std::vector<Part> parts;
  std::vector<int> part_of;  // of each column
  const auto n = static_cast<int>(tree.parent.size());
  for (int c = 0; c < n; ++c) {
    if (c > 0 && tree.parent[c - 1] == c && tree.counts[c - 1] == tree.counts[c] + 1) {
      parts.back().last = c;
      ++parts.back().columns;
    } else {
      parts.push_back({c, c, -1, -1, 1, static_cast<double>(tree.counts[c]), 0});
    }
    part_of.push_back(static_cast<int>(parts.size()) - 1);
  }
  for (Part& part : parts) {
    if (tree.parent[part.last] >= 0) part.parent = part_of[tree.parent[part.last]];
  }
  return parts;
}

void merge_with_parents(std::vector<Part>& parts, int width) {
  std::vector<int> largest(parts.size(), -1);  // child of the most rows
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Part& part = parts[p];
    if (largest[p] >= 0) {
      Part& child = parts[largest[p]];
      const double columns = child.columns + part.columns, rows = child.columns + part.rows;
      const double zeros = entries(columns, rows) - (entries(child.columns, child.rows) - child.zeros) -
                           (entries(part.columns, part.rows) - part.zeros);
      if (std::ranges::any_of(kAllowances, [&](const Allowance& allowed) {
            return width * columns <= allowed.columns && zeros <= allowed.zeros * entries(columns, rows);
          })) {
        child.merged_into = static_cast<int>(p);
        part.columns = columns;
        part.rows = rows;
        part.zeros = zeros;
      }
    }
    if (part.parent < 0) continue;
    int& other = largest[part.parent];
    if (other < 0 || part.rows > parts[other].rows) other = static_cast<int>(p);
  }
}

/// Places the columns of each supernode side by side, after those of its descendants. Returns the parent of
/// each supernode.
std::vector<int> place_columns(const Elimination& tree, const std::vector<Part>& parts, Supernodes& result) {
  std::vector<int> root_of(parts.size()), number(parts.size(), -1);  // number: of the supernode
  std::vector<int> roots;                                            // part that each supernode grew from
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].merged_into >= 0) continue;
    number[p] = static_cast<int>(roots.size());
    roots.push_back(static_cast<int>(p));
  }
  for (std::size_t p = parts.size(); p-- > 0;)
    root_of[p] = parts[p].merged_into < 0 ? static_cast<int>(p) : root_of[parts[p].merged_into];
  std::vector<std::vector<int>> parts_of(roots.size());
  for (std::size_t p = 0; p < parts.size(); ++p) parts_of[number[root_of[p]]].push_back(static_cast<int>(p));
  std::vector<int> parent;
  for (const int root : roots)
    parent.push_back(parts[root].parent < 0 ? -1 : number[root_of[parts[root].parent]]);
  const std::vector<int> sequence = postorder(parent);
  for (const int s : sequence) {
    for (const int p : parts_of[s]) {
      for (int c = parts[p].first; c <= parts[p].last; ++c) result.order.push_back(tree.order[c]);
    }
    result.first.push_back(static_cast<int>(result.order.size()));
  }
  return renumbered_parents(parent, sequence);
}

/// Rows of a supernode: of its columns in the matrix, and of its children.
void find_rows(const MatrixGraph& graph, std::span<const int> parent, Supernodes& result) {
  std::vector<int> place(result.order.size()), last_taken_by(result.order.size(), -1);
  for (std::size_t k = 0; k < place.size(); ++k) place[result.order[k]] = static_cast<int>(k);
  std::vector<std::vector<int>> children(parent.size());
  for (std::size_t s = 0; s < parent.size(); ++s) {
    if (parent[s] >= 0) children[parent[s]].push_back(static_cast<int>(s));
  }
  for (int s = 0; s < result.count(); ++s) {
    const int end = result.first[s + 1];
    for (int c = result.first[s]; c < end; ++c) result.rows.push_back(c);
    const auto own = static_cast<std::ptrdiff_t>(result.rows.size());
    const auto take = [&](int row) {
      if (row < end || std::exchange(last_taken_by[row], s) == s) return;
      result.rows.push_back(row);
    };
    for (int c = result.first[s]; c < end; ++c) {
      for (const int vertex : graph.neighbours_of(result.order[c])) take(place[vertex]);
    }
    for (const int child : children[s]) {
      for (std::size_t k = result.rows_start[child]; k < result.rows_start[child + 1]; ++k)
        take(result.rows[k]);
    }
    std::sort(result.rows.begin() + own, result.rows.end());
    result.rows_start.push_back(result.rows.size());
  }
}

}  // namespace

Supernodes find_supernodes(const MatrixGraph& graph, const Elimination& elimination, int width) {
  std::vector<Part> parts = fundamental_parts(elimination);
  merge_with_parents(parts, width);
  Supernodes result;
  const std::vector<int> parent = place_columns(elimination, parts, result);
  find_rows(graph, parent, result);
  return result;
}

}  // namespace palpate::sim
