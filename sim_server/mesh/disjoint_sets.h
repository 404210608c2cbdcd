#pragma once
#include <numeric>
#include <vector>

namespace palpate::sim {

/// Sets of the numbers from 0 to n - 1, joined two by two: union-find (Tarjan 1975, J. ACM 22:215). Each
/// operation is close to O(1).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// The representative of the set that holds `i`; halves the path on the way.
  int of(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Joins the sets of i and j; returns true if they were two sets before.
  bool join(int i, int j) {
    const int a = of(i), b = of(j);
    parent_[a] = b;
    return a != b;
  }
  /// (n) The set of each, numbered from 0 in the order of their first members.
  std::vector<int> numbers() {
    std::vector<int> number(parent_.size(), -1), set;
    int sets = 0;
    for (int i = 0; i < static_cast<int>(parent_.size()); ++i) {
      int& own = number[of(i)];
      if (own < 0) own = sets++;
      set.push_back(own);
    }
    return set;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace palpate::sim
