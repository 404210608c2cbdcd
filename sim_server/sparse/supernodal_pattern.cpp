#include "sim_server/sparse/supernodal_pattern.h"

#include <algorithm>
#include <mutex>
#include <new>
#include <numeric>
#include <suitesparse/cholmod.h>

namespace palpate::sim {
namespace {

// A subtree with more than this share of all work is cut.
constexpr double kLargestShare = 0.06;

/// A matrix of the same pattern as another, one entry for each 3 x 3 block: CHOLMOD's lists.
struct NodeGraph {
  std::vector<int> outer{0}, inner;

  explicit NodeGraph(const SparseMatrix& lower) {
    for (Eigen::Index column = 0; column < lower.cols(); column += 3) {
      const int* const outer_of = lower.outerIndexPtr() + column;
      for (int k = outer_of[0]; k < outer_of[1]; k += 3) inner.push_back(lower.innerIndexPtr()[k] / 3);
      outer.push_back(static_cast<int>(inner.size()));
    }
  }
};

/// CHOLMOD's view of the lower triangle of a pattern.
cholmod_sparse view(std::span<const int> outer, std::span<const int> inner) {
  cholmod_sparse a{};
  a.nrow = a.ncol = outer.size() - 1;
  a.nzmax = inner.size();
  a.p = const_cast<int*>(outer.data());  // it only reads
  a.i = const_cast<int*>(inner.data());
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;
  return a;
}

/// CHOLMOD with its settings.
struct Cholmod {
  cholmod_common common;

  Cholmod() {
    cholmod_start(&common);
    common.print = 0;  // errors are ours to word
    // Merge more columns than by default, twice as many zeros: fewer, larger products are quicker.
    for (auto& columns : common.nrelax) columns *= 2;
    common.zrelax[1] *= 2;
    common.zrelax[2] *= 2;
  }
  ~Cholmod() { cholmod_finish(&common); }

  /// The order of three unknowns a node. On all of 14 meshes of 343 to 20 402 nodes METIS gave the factor of
  /// fewer multiplications, by 6 to 57 %; AMD serves where CHOLMOD was built without it. METIS seeds the
  /// sequence of random numbers that all threads share: two at a time would each find another order in each
  /// run.
  std::vector<int> order_of(const NodeGraph& graph) {
    static std::mutex one_at_a_time;
    const std::scoped_lock lock(one_at_a_time);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.nmethods = 1;
    cholmod_sparse nodes = view(graph.outer, graph.inner);
    cholmod_factor* ordered = nullptr;
    for (const int ordering : {CHOLMOD_METIS, CHOLMOD_AMD}) {
      common.method[0].ordering = ordering;
      if (ordered == nullptr) ordered = cholmod_analyze(&nodes, &common);
    }
    std::vector<int> order;
    for (std::size_t k = 0; ordered != nullptr && k < nodes.ncol; ++k) {
      for (int axis = 0; axis < 3; ++axis) order.push_back(3 * static_cast<int*>(ordered->Perm)[k] + axis);
    }
    cholmod_free_factor(&ordered, &common);
    return order;
  }

  cholmod_factor* analyze(const SparseMatrix& lower, std::vector<int>& order) {
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    cholmod_sparse all = view({lower.outerIndexPtr(), static_cast<std::size_t>(lower.cols()) + 1},
                              {lower.innerIndexPtr(), static_cast<std::size_t>(lower.nonZeros())});
    return cholmod_analyze_p(&all, order.data(), nullptr, 0, &common);
  }
};

template <class To>
std::vector<To> copied(const void* from, std::size_t count) {
  const int* const values = static_cast<const int*>(from);
  return std::vector<To>(values, values + count);
}

}  // namespace

SupernodalPattern::SupernodalPattern(const SparseMatrix& lower) {
  if (lower.rows() == 0) {
    first = {0};
    rows_begin = values_begin = updates_begin = {0};
    return;
  }
  Cholmod cholmod;
  std::vector<int> nodal = cholmod.order_of(NodeGraph(lower));
  cholmod_factor* found = nodal.empty() ? nullptr : cholmod.analyze(lower, nodal);
  if (found == nullptr) {
    if (cholmod.common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    countable = false;
    return;
  }
  order = copied<int>(found->Perm, found->n);
  first = copied<int>(found->super, found->nsuper + 1);
  rows = copied<int>(found->s, found->ssize);
  rows_begin = copied<std::size_t>(found->pi, found->nsuper + 1);
  values_begin = copied<std::size_t>(found->px, found->nsuper + 1);
  cholmod_free_factor(&found, &cholmod.common);
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
  updates_begin.assign(static_cast<std::size_t>(supernodes()) + 1, 0);
  each([&](int target, const Update&) { ++updates_begin[target + 1]; });
  std::partial_sum(updates_begin.begin(), updates_begin.end(), updates_begin.begin());
  updates.resize(updates_begin.back());
  std::vector<std::size_t> next = updates_begin;
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
          static_cast<int>(values_begin[s]) + (column - first[s]) * static_cast<int>(below.size());
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
    if (work[s] > kLargestShare * all) {
      top.push_back(s);
    } else if (parent[s] < 0 || work[parent[s]] > kLargestShare * all) {
      subtrees.push_back({begin[s], s + 1});
    }
  }
  std::reverse(top.begin(), top.end());
  std::sort(subtrees.begin(), subtrees.end(), [&](const Subtree& a, const Subtree& b) {
    return std::pair(-work[a.end - 1], a.begin) < std::pair(-work[b.end - 1], b.begin);
  });
}

std::size_t SupernodalPattern::bytes() const {
  return (order.size() + first.size() + rows.size() + place.size() + top.size()) * sizeof(int) +
         (rows_begin.size() + values_begin.size() + updates_begin.size()) * sizeof(std::size_t) +
         updates.size() * sizeof(Update) + subtrees.size() * sizeof(Subtree);
}

}  // namespace palpate::sim
