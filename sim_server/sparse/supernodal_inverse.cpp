#include <algorithm>
#include <numeric>

#include "common/parallel.h"
#include "sim_server/sparse/blas.h"
#include "sim_server/sparse/supernodal_factor.h"

namespace palpate::sim {
namespace {

constexpr std::size_t kColumns = 96;  // of the inverse at once: enough to keep BLAS busy
constexpr std::size_t kBlocks = 32;   // between two reports of progress

}  // namespace

/// Which supernodes take part where a few rows and columns of the inverse are wanted.
class InversePlan {
 public:
  InversePlan(const SupernodalPattern& pattern, std::span<const int> unknowns)
      : pattern_(pattern), wanted_(unknowns.size()), node_(pattern.order.size()) {
    std::vector<int> place(pattern.order.size());
    for (std::size_t k = 0; k < place.size(); ++k) place[pattern.order[k]] = static_cast<int>(k);
    for (std::size_t k = 0; k < unknowns.size(); ++k) wanted_[k] = {place[unknowns[k]], static_cast<int>(k)};
    std::ranges::sort(wanted_);
    for (int s = 0; s < pattern.supernodes(); ++s)
      std::fill(node_.begin() + pattern.first[s], node_.begin() + pattern.first[s + 1], s);
    above_.assign(static_cast<std::size_t>(pattern.supernodes()), 0);
    mark_above(wanted_, above_);
  }

  /// An unknown: its place in the order of elimination, and its number among those wanted.
  struct Wanted {
    int place, number;
    auto operator<=>(const Wanted&) const = default;  // NOLINT(modernize-use-nullptr): it is none
  };
  std::span<const Wanted> wanted() const { return wanted_; }
  int supernode(const Wanted& one) const { return node_[one.place]; }
  /// Whether something wanted is at or under a supernode in the tree of elimination.
  bool above_wanted(int s) const { return above_[s] != 0; }

  /// Marks the supernodes at or above those of `some`: where a load on them goes in forward elimination.
  void mark_above(std::span<const Wanted> some, std::vector<char>& marks) const {
    for (const Wanted& one : some) marks[supernode(one)] = 1;
    for (int s = 0; s < pattern_.supernodes(); ++s) {
      const std::span<const int> rows = pattern_.rows_of(s);
      const auto columns = static_cast<std::size_t>(pattern_.columns(s));
      if (marks[s] != 0 && rows.size() > columns) marks[node_[rows[columns]]] = 1;
    }
  }

 private:
  const SupernodalPattern& pattern_;
  std::vector<Wanted> wanted_;  // ascending by place
  std::vector<int> node_;       // (n) supernode of each place
  std::vector<char> above_;
};

/// Columns of the inverse from the place of the first of them downwards, for unit loads: transposed, so that
/// what belongs to one unknown lies together.
template <class Scalar>
class SupernodalFactor<Scalar>::InverseColumns {
 public:
  InverseColumns(const SupernodalFactor& factor, const InversePlan& plan,
                 std::span<const InversePlan::Wanted> loads)
      : factor_(factor),
        pattern_(*factor.pattern_),
        begin_(plan.supernode(loads.front())),
        base_(pattern_.first[begin_]),
        count_(static_cast<int>(loads.size())),
        x_(Matrix::Zero(count_, static_cast<Eigen::Index>(pattern_.order.size()) - base_)) {
    std::vector<char> loaded(static_cast<std::size_t>(pattern_.supernodes()), 0);
    plan.mark_above(loads, loaded);
    for (int j = 0; j < count_; ++j) x_(j, loads[j].place - base_) = 1;
    for (int s = begin_; s < pattern_.supernodes(); ++s) {
      if (loaded[s] != 0) forward(s);
    }
    for (int s = pattern_.supernodes() - 1; s >= begin_; --s) {
      if (plan.above_wanted(s)) backward(s);
    }
  }

  Scalar at(int load, int place) const { return x_(load, place - base_); }

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
  int begin_, base_, count_;
  Matrix x_;      // (count x places from `base_` on)
  Matrix below_;  // scratch
};

template <class Scalar>
void SupernodalFactor<Scalar>::inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                                             const std::function<void(double)>& progress) const {
  const InversePlan plan(*pattern_, unknowns);
  const std::span wanted = plan.wanted();
  for (std::size_t from = 0; from < wanted.size(); from += kBlocks * kColumns) {
    progress(static_cast<double>(from) / static_cast<double>(wanted.size()));
    const std::span some = wanted.subspan(from, std::min(kBlocks * kColumns, wanted.size() - from));
    parallel_blocks(some.size(), kColumns, [&](std::size_t begin, std::size_t end) {
      const InverseColumns columns(*this, plan, some.subspan(begin, end - begin));
      for (std::size_t j = begin; j < end; ++j) {
        for (const auto& row : wanted.subspan(from + j)) {
          const auto value = static_cast<double>(columns.at(static_cast<int>(j - begin), row.place));
          block(row.number, some[j].number) = value;
          block(some[j].number, row.number) = value;
        }
      }
    });
  }
}

template void SupernodalFactor<double>::inverse_block(std::span<const int>, Eigen::Ref<Eigen::MatrixXd>,
                                                      const std::function<void(double)>&) const;
template void SupernodalFactor<float>::inverse_block(std::span<const int>, Eigen::Ref<Eigen::MatrixXd>,
                                                     const std::function<void(double)>&) const;

}  // namespace palpate::sim
