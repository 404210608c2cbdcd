#include "sim_server/sparse/supernodal_pattern.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "sim_server/sparse/fill_reducing_order.h"
#include "sim_server/sparse/supernodes.h"

namespace palpate::sim {
namespace {

constexpr int kAxes = 3;  // unknowns of a node
// A subtree with more than this share of all work is cut.
constexpr double kLargestFraction = 0.06;

}  // namespace

SupernodalPattern::SupernodalPattern(const SparseMatrix& lower) {
  if (lower.rows() == 0) {
    first = {0};
    rows_start = values_start = updates_start = {0};
    return;
  }
  const MatrixGraph graph = MatrixGraph::of_blocks(lower);
  const Supernodes nodal = find_supernodes(graph, fill_reducing_order(graph), kAxes);
  const auto expand = [](std::span<const int> from, std::vector<int>& to) {
    for (const int v : from) {
      for (int axis = 0; axis < kAxes; ++axis) to.push_back(kAxes * v + axis);
    }
  };
  expand(nodal.order, order);
  expand(nodal.rows, rows);
  for (const int c : nodal.first) first.push_back(kAxes * c);
  for (const std::size_t begin : nodal.rows_start) rows_start.push_back(kAxes * begin);
  values_start = {0};
  for (int s = 0; s < supernodes(); ++s)
    values_start.push_back(values_start.back() + static_cast<std::size_t>(columns(s)) * rows_of(s).size());
  countable = values() <= std::numeric_limits<int>::max();
  if (!countable) return;
  find_updates();
  find_places(lower);
  cut_subtrees();
}

/// Each supernode updates those whose columns are among its rows.
void SupernodalPattern::find_updates() {
  std::vector<int> owner(order.size());  // of each column
  for (int s = 0; s < supernodes(); ++s) std::fill(owner.begin() + first[s], owner.begin() + first[s + 1], s);
  const auto each = [&](const auto& work) {
    for (int source = 0; source < supernodes(); ++source) {
      const std::span<const int> below = rows_of(source);
      const auto count = static_cast<int>(below.size());
      for (int from = columns(source), to = from; from < count; from = to) {
        const int target = owner[below[from]];
        while (to < count && owner[below[to]] == target) ++to;
        work(target, Update{source, from, to});
      }
    }
  };
  updates_start.assign(static_cast<std::size_t>(supernodes()) + 1, 0);
  each([&](int target, const Update&) { ++updates_start[target + 1]; });
  std::partial_sum(updates_start.begin(), updates_start.end(), updates_start.begin());
  updates.resize(updates_start.back());
  std::vector<std::size_t> next = updates_start;
  each([&](int target, const Update& update) { updates[next[target]++] = update; });
}

void SupernodalPattern::find_places(const SparseMatrix& lower) {
  std::vector<int> at(order.size());  // where each unknown is eliminated
  for (std::size_t k = 0; k < order.size(); ++k) at[order[k]] = static_cast<int>(k);
  // Entries of the matrix by the column of L that they stand in, with their row there.
  struct Entry {
    int entry, row;
  };
  std::vector<std::size_t> begin(order.size() + 1, 0);
  const auto each = [&](const auto& work) {
    for (int column = 0; column < lower.outerSize(); ++column) {
      for (int k = lower.outerIndexPtr()[column]; k < lower.outerIndexPtr()[column + 1]; ++k) {
        const int row = lower.innerIndexPtr()[k];
        if (row >= column) work(k, std::max(at[row], at[column]), std::min(at[row], at[column]));
      }
    }
  };
  each([&](int, int, int column) { ++begin[column + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Entry> entries(begin.back());
  std::vector<std::size_t> next = begin;
  each([&](int k, int row, int column) { entries[next[column]++] = {k, row}; });
  place.assign(static_cast<std::size_t>(lower.nonZeros()), -1);
  std::vector<int> local(order.size());
  for (int s = 0; s < supernodes(); ++s) {
    const std::span<const int> below = rows_of(s);
    for (std::size_t i = 0; i < below.size(); ++i) local[below[i]] = static_cast<int>(i);
    for (int column = first[s]; column < first[s + 1]; ++column) {
      const auto top_of =
          static_cast<int>(values_start[s]) + (column - first[s]) * static_cast<int>(below.size());
      for (std::size_t k = begin[column]; k < begin[column + 1]; ++k)
        place[entries[k].entry] = top_of + local[entries[k].row];
    }
  }
}

/// Cuts the tree at the top until no subtree has too much of the work, by multiplications.
void SupernodalPattern::cut_subtrees() {
  const int count = supernodes();
  std::vector<double> work(static_cast<std::size_t>(count), 0);  // of each with all below it
  std::vector<int> begin(static_cast<std::size_t>(count)), parent(static_cast<std::size_t>(count), -1);
  std::iota(begin.begin(), begin.end(), 0);
  std::vector<int> owner(order.size());
  for (int s = 0; s < count; ++s) std::fill(owner.begin() + first[s], owner.begin() + first[s + 1], s);
  double& all = multiplications;
  for (int s = 0; s < count; ++s) {
    const std::span<const int> below = rows_of(s);
    const auto high = static_cast<double>(below.size()), wide = static_cast<double>(columns(s));
    double own = wide * wide * high;
    for (const Update& u : updates_of(s)) {
      own += static_cast<double>(u.to - u.from) *
             static_cast<double>(rows_of(u.source).size() - static_cast<std::size_t>(u.from)) *
             columns(u.source);
    }
    work[s] += own;
    all += own;
    if (static_cast<int>(below.size()) == columns(s)) continue;
    parent[s] = owner[below[columns(s)]];
    work[parent[s]] += work[s];
    begin[parent[s]] = std::min(begin[parent[s]], begin[s]);
  }
  for (int s = count - 1; s >= 0; --s) {
    if (work[s] > kLargestFraction * all) {
      top.push_back(s);
    } else if (parent[s] < 0 || work[parent[s]] > kLargestFraction * all) {
      subtrees.push_back({begin[s], s + 1});
    }
  }
  std::ranges::reverse(top);
  std::ranges::sort(subtrees, [&](const Subtree& a, const Subtree& b) {
    return std::pair(-work[a.end - 1], a.begin) < std::pair(-work[b.end - 1], b.begin);
  });
}

std::size_t SupernodalPattern::bytes() const {
  return (order.size() + first.size() + rows.size() + place.size() + top.size()) * sizeof(int) +
         (rows_start.size() + values_start.size() + updates_start.size()) * sizeof(std::size_t) +
         updates.size() * sizeof(Update) + subtrees.size() * sizeof(Subtree);
}

}  // namespace palpate::sim
