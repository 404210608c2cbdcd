#include <algorithm>
#include <numeric>

#include "common/parallel.h"
#include "sim_server/sparse/blas.h"
#include "sim_server/sparse/supernodal_factor.h"

namespace palpate::sim {
namespace {

constexpr std::size_t kColumns = 96;  // of the inverse at once: enough to keep BLAS busy
constexpr std::size_t kBlocks = 32;   // between two reports of progress
constexpr std::size_t kGroups = 8;    // of rows between two reports

}  // namespace

/// The supernodes that take part where a few rows and columns of the inverse are wanted.
class InversePlan {
 public:
  InversePlan(const SupernodalPattern& pattern, std::span<const int> unknowns)
      : pattern_(pattern), wanted_(unknowns.size()), node_(pattern.order.size()) {
    std::vector<int> place(pattern.order.size());
    for (std::size_t k = 0; k < place.size(); ++k) place[pattern.order[k]] = static_cast<int>(k);
    for (std::size_t k = 0; k < unknowns.size(); ++k) wanted_[k] = {place[unknowns[k]], static_cast<int>(k)};
    for (int s = 0; s < pattern.supernodes(); ++s)
      std::fill(node_.begin() + pattern.first[s], node_.begin() + pattern.first[s + 1], s);
  }

  /// An unknown: its place in the order of elimination, and its number among those wanted.
  struct Wanted {
    int place, number;
    auto operator<=>(const Wanted&) const = default;  // NOLINT(modernize-use-nullptr): it is none
  };
  std::span<const Wanted> wanted() const { return wanted_; }
  int supernode(const Wanted& one) const { return node_[one.place]; }

  /// Returns, of each supernode, whether it is at or above that of one of `some` in the tree of elimination:
  /// where a load on them goes in forward elimination, and what their rows are found from in the backward
  /// one.
  std::vector<char> above(std::span<const Wanted> some) const {
    std::vector<char> marks(static_cast<std::size_t>(pattern_.supernodes()), 0);
    for (const Wanted& one : some) marks[supernode(one)] = 1;
    for (int s = 0; s < pattern_.supernodes(); ++s) {
      const std::span<const int> rows = pattern_.rows_of(s);
      const auto columns = static_cast<std::size_t>(pattern_.columns(s));
      if (marks[s] != 0 && rows.size() > columns) marks[node_[rows[columns]]] = 1;
    }
    return marks;
  }

  /// Numbers of groups of the unknowns, by where these are eliminated in the mean.
  std::vector<int> in_order_of_elimination(std::span<const int> begins) const {
    std::vector<std::pair<double, int>> groups;
    for (std::size_t g = 0; g + 1 < begins.size(); ++g) {
      double places = 0;
      for (int k = begins[g]; k < begins[g + 1]; ++k) places += wanted_[static_cast<std::size_t>(k)].place;
      groups.emplace_back(places / (begins[g + 1] - begins[g]), static_cast<int>(g));
    }
    std::ranges::sort(groups);
    std::vector<int> order;
    for (const auto& [place, group] : groups) order.push_back(group);
    return order;
  }

 private:
  const SupernodalPattern& pattern_;
  std::vector<Wanted> wanted_;  // ascending by number
  std::vector<int> node_;       // (n) supernode of each place
};

/// Columns of the inverse for unit loads, transposed, so that what belongs to one unknown lies together: the
/// rows of the supernodes that are marked, and nothing before the first of these.
template <class Scalar>
class SupernodalFactor<Scalar>::InverseColumns {
 public:
  /// `rows`: the supernodes above what is looked at. Loads ascend by place, and lie within these.
  InverseColumns(const SupernodalFactor& factor, const InversePlan& plan,
                 std::span<const InversePlan::Wanted> loads, std::span<const char> rows)
      : factor_(factor),
        pattern_(*factor.pattern_),
        base_(pattern_.first[std::ranges::find(rows, 1) - rows.begin()]),
        count_(static_cast<int>(loads.size())),
        x_(Matrix::Zero(count_, static_cast<Eigen::Index>(pattern_.order.size()) - base_)) {
    const std::vector<char> loaded = plan.above(loads);
    for (int j = 0; j < count_; ++j) x_(j, loads[j].place - base_) = 1;
    for (int s = plan.supernode(loads.front()); s < pattern_.supernodes(); ++s) {
      if (loaded[s] != 0) forward(s);
    }
    for (int s = pattern_.supernodes() - 1; s >= 0; --s) {
      if (rows[s] != 0) backward(s);
    }
  }

  /// Returns what belongs to one unknown, (loads).
  auto of(const InversePlan::Wanted& unknown) const { return x_.col(unknown.place - base_); }

 private:
  void forward(int s) {
    const std::span<const int> rows = pattern_.rows_of(s);
    const int height = static_cast<int>(rows.size()), columns = pattern_.columns(s), under = height - columns;
    const Scalar* const l = factor_.block(s);
    Scalar* const own = x_.col(pattern_.first[s] - base_).data();
    const Scalar one = 1, zero = 0;
    Blas<Scalar>::trsm("R", "L", "T", "N", &count_, &columns, &one, l, &height, own, &count_);
    if (under == 0) return;
    below_.resize(count_, std::max<Eigen::Index>(below_.cols(), under));
    Blas<Scalar>::gemm("N", "T", &count_, &under, &columns, &one, own, &count_, l + columns, &height, &zero,
                       below_.data(), &count_);
    for (int i = 0; i < under; ++i) x_.col(rows[columns + i] - base_) -= below_.col(i);
  }

  void backward(int s) {
    const std::span<const int> rows = pattern_.rows_of(s);
    const int height = static_cast<int>(rows.size()), columns = pattern_.columns(s), under = height - columns;
    const Scalar* const l = factor_.block(s);
    Scalar* const own = x_.col(pattern_.first[s] - base_).data();
    const Scalar one = 1, minus = -1;
    if (under > 0) {
      below_.resize(count_, std::max<Eigen::Index>(below_.cols(), under));
      for (int i = 0; i < under; ++i) below_.col(i) = x_.col(rows[columns + i] - base_);
      Blas<Scalar>::gemm("N", "N", &count_, &columns, &under, &minus, below_.data(), &count_, l + columns,
                         &height, &one, own, &count_);
    }
    Blas<Scalar>::trsm("R", "L", "N", "N", &count_, &columns, &one, l, &height, own, &count_);
  }

  const SupernodalFactor& factor_;
  const SupernodalPattern& pattern_;
  int base_, count_;
  Matrix x_;      // (count x places from `base_` on)
  Matrix below_;  // scratch
};

template <class Scalar>
void SupernodalFactor<Scalar>::inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                                             const std::function<void(double)>& progress) const {
  const InversePlan plan(*pattern_, unknowns);
  std::vector<InversePlan::Wanted> sorted(plan.wanted().begin(), plan.wanted().end());
  std::ranges::sort(sorted);
  const std::span<const InversePlan::Wanted> wanted = sorted;
  for (std::size_t from = 0; from < wanted.size(); from += kBlocks * kColumns) {
    progress(static_cast<double>(from) / static_cast<double>(wanted.size()));
    const std::span some = wanted.subspan(from, std::min(kBlocks * kColumns, wanted.size() - from));
    parallel_blocks(some.size(), kColumns, [&](std::size_t begin, std::size_t end) {
      const std::span loads = some.subspan(begin, end - begin), rows = wanted.subspan(from + begin);
      const InverseColumns columns(*this, plan, loads, plan.above(rows));
      for (std::size_t k = 0; k < rows.size(); ++k) {
        const auto row = columns.of(rows[k]);
        for (std::size_t j = 0; j <= std::min(k, loads.size() - 1); ++j) {
          const auto value = static_cast<double>(row[static_cast<Eigen::Index>(j)]);
          block(rows[k].number, loads[j].number) = value;
          block(loads[j].number, rows[k].number) = value;
        }
      }
    });
  }
}

template <class Scalar>
void SupernodalFactor<Scalar>::inverse_rows(std::span<const int> unknowns, std::span<const int> begins,
                                            const FactoredMatrix::TakeRows& take,
                                            const std::function<void(double)>& progress) const {
  const InversePlan plan(*pattern_, unknowns);
  const std::span<const InversePlan::Wanted> wanted = plan.wanted();
  const std::vector<int> order = plan.in_order_of_elimination(begins);
  const auto unknowns_of = [&](int group) {
    return wanted.subspan(static_cast<std::size_t>(begins[group]),
                          static_cast<std::size_t>(begins[group + 1] - begins[group]));
  };
  const auto rows_of = [&](std::size_t k) {
    const std::span with = std::span<const int>(order).subspan(k);
    std::vector<InversePlan::Wanted> loads(unknowns_of(order[k]).begin(), unknowns_of(order[k]).end()), all;
    std::ranges::sort(loads);
    for (const int group : with) std::ranges::copy(unknowns_of(group), std::back_inserter(all));
    const std::vector<char> above = plan.above(all);
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(loads.size()), static_cast<Eigen::Index>(wanted.size()));
    for (std::size_t from = 0; from < loads.size(); from += kColumns) {
      const std::span some = std::span(loads).subspan(from, std::min(kColumns, loads.size() - from));
      const InverseColumns columns(*this, plan, some, above);
      for (const InversePlan::Wanted& one : all) {
        const auto row = columns.of(one);
        for (std::size_t j = 0; j < some.size(); ++j)
          rows(some[j].number - begins[order[k]], one.number) =
              static_cast<double>(row[static_cast<Eigen::Index>(j)]);
      }
    }
    take(order[k], with, rows);
  };
  for (std::size_t from = 0; from < order.size(); from += kGroups) {
    progress(static_cast<double>(from) / static_cast<double>(order.size()));
    parallel_blocks(std::min(kGroups, order.size() - from), 1,
                    [&](std::size_t k, std::size_t) { rows_of(from + k); });
  }
}

template void SupernodalFactor<double>::inverse_block(std::span<const int>, Eigen::Ref<Eigen::MatrixXd>,
                                                      const std::function<void(double)>&) const;
template void SupernodalFactor<double>::inverse_rows(std::span<const int>, std::span<const int>,
                                                     const FactoredMatrix::TakeRows&,
                                                     const std::function<void(double)>&) const;
template void SupernodalFactor<float>::inverse_block(std::span<const int>, Eigen::Ref<Eigen::MatrixXd>,
                                                     const std::function<void(double)>&) const;
template void SupernodalFactor<float>::inverse_rows(std::span<const int>, std::span<const int>,
                                                    const FactoredMatrix::TakeRows&,
                                                    const std::function<void(double)>&) const;

}  // namespace palpate::sim
