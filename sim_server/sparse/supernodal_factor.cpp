#include "sim_server/sparse/supernodal_factor.h"

#include <algorithm>
#include <atomic>

#include "common/parallel.h"
#include "sim_server/sparse/blas.h"

namespace palpate::sim {
namespace {

constexpr int kBand = 256;   // rows of a supernode that one task works on
constexpr int kPanel = 256;  // columns of a large one that are eliminated at once
constexpr int kFew = 3;  // right-hand sides that go one by one: to multiply more at once BLAS packs the block

/// True if ascending numbers leave none out.
bool without_gap(std::span<const int> numbers) {
  return numbers.empty() || numbers.back() - numbers.front() == static_cast<int>(numbers.size()) - 1;
}

}  // namespace

template <class Scalar>
SupernodalFactor<Scalar>::SupernodalFactor(const SupernodalPattern& pattern)
    : pattern_(&pattern), values_(pattern.values()) {
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);  // the same bits everywhere
}

template <class Scalar>
bool SupernodalFactor<Scalar>::factor(const SparseMatrix& lower) {
  std::ranges::fill(values_, Scalar(0));
  for (std::size_t k = 0; k < pattern_->place.size(); ++k) {
    if (pattern_->place[k] >= 0) values_[pattern_->place[k]] = static_cast<Scalar>(lower.valuePtr()[k]);
  }
  std::atomic<bool> definite = true;
  const std::size_t n = pattern_->order.size();
  parallel_blocks(pattern_->subtrees.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      std::vector<int> local(n);
      const auto& [from, to] = pattern_->subtrees[t];
      for (int s = from; s < to && definite; ++s) {
        if (!eliminate(s, false, local)) definite = false;
      }
    }
  });
  std::vector<int> local(n);
  for (const int s : pattern_->top) {
    if (!definite || !eliminate(s, true, local)) return false;
  }
  return definite;
}

/// Subtracts from rows `from` to `to` of a supernode what all before it have there.
template <class Scalar>
void SupernodalFactor<Scalar>::assemble(int s, int from, int to, const std::vector<int>& local) {
  std::vector<Scalar> scratch;
  const int height = static_cast<int>(pattern_->rows_of(s).size());
  const Scalar one = 1, minus = -1, zero = 0;
  for (const auto& update : pattern_->updates_of(s)) {
    const std::span<const int> rows = pattern_->rows_of(update.source);
    const auto below = [&](int row, int limit) { return local[row] < limit; };
    const auto begin = std::lower_bound(rows.begin() + update.from, rows.end(), from, below);
    const auto end = std::lower_bound(begin, rows.end(), to, below);
    // Nothing above the diagonal.
    const auto last = std::lower_bound(rows.begin() + update.from, rows.begin() + update.to, to, below);
    const int m = static_cast<int>(end - begin), w = static_cast<int>(last - rows.begin()) - update.from,
              k = pattern_->columns(update.source), ld = static_cast<int>(rows.size());
    if (m == 0) continue;
    const Scalar* const source = block(update.source);
    const Scalar *const a = source + (begin - rows.begin()), *const b = source + update.from;
    Scalar* const into = block(s);
    if (local[*(end - 1)] - local[*begin] == m - 1 && without_gap(rows.subspan(update.from, w))) {
      Blas<Scalar>::gemm("N", "T", &m, &w, &k, &minus, a, &ld, b, &ld, &one,
                         into + local[*begin] + static_cast<std::size_t>(local[rows[update.from]]) * height,
                         &height);
      continue;
    }
    scratch.resize(std::max(scratch.size(), static_cast<std::size_t>(m) * w));
    Scalar* const product = scratch.data();
    Blas<Scalar>::gemm("N", "T", &m, &w, &k, &one, a, &ld, b, &ld, &zero, product, &m);
    for (int j = 0; j < w; ++j) {
      Scalar* const column = into + static_cast<std::size_t>(local[rows[update.from + j]]) * height;
      for (int i = 0; i < m; ++i) column[local[begin[i]]] -= product[j * m + i];
    }
  }
}

/// Columns of L of one supernode; where it is large, by panels of columns and bands of rows on all cores.
/// `local` (n) is to write on: where each row of the matrix is in it.
template <class Scalar>
bool SupernodalFactor<Scalar>::eliminate(int s, bool large, std::vector<int>& local) {
  const std::span<const int> rows = pattern_->rows_of(s);
  for (std::size_t i = 0; i < rows.size(); ++i) local[rows[i]] = static_cast<int>(i);
  const int height = static_cast<int>(rows.size()), columns = pattern_->columns(s);
  const auto by_bands = [large](int count, const auto& work) {
    if (large) {
      parallel_blocks(static_cast<std::size_t>(count), kBand, [&](std::size_t begin, std::size_t end) {
        work(static_cast<int>(begin), static_cast<int>(end));
      });
    } else {
      for (int begin = 0; begin < count; begin += kBand) work(begin, std::min(count, begin + kBand));
    }
  };
  by_bands(height, [&](int begin, int end) { assemble(s, begin, end, local); });
  Scalar* const l = block(s);
  const Scalar one = 1, minus = -1;
  const int panel = large ? kPanel : columns;
  for (int from = 0; from < columns; from += panel) {
    const int width = std::min(panel, columns - from), to = from + width;
    Scalar* const at = l + static_cast<std::size_t>(from) * height;  // column `from`
    int failed = 0;
    Blas<Scalar>::potrf("L", &width, at + from, &height, &failed);
    if (failed != 0) return false;
    by_bands(height - to, [&](int begin, int end) {
      const int band = end - begin;
      Blas<Scalar>::trsm("R", "L", "T", "N", &band, &width, &one, at + from, &height, at + to + begin,
                         &height);
    });
    // What is right of the panel, nothing above the diagonal.
    by_bands(to < columns ? height - to : 0, [&](int begin, int end) {
      const int band = end - begin, wide = std::min(columns - to, end);
      Blas<Scalar>::gemm("N", "T", &band, &wide, &width, &minus, at + to + begin, &height, at + to, &height,
                         &one, l + static_cast<std::size_t>(to) * height + to + begin, &height);
    });
  }
  return true;
}

template <class Scalar>
auto SupernodalFactor<Scalar>::solve(const Matrix& b) const -> Matrix {
  if (b.size() == 0) return b;  // nothing to be moved about in
  Matrix x(b.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    for (Eigen::Index k = 0; k < b.rows(); ++k) x(k, j) = b(pattern_->order[k], j);
  }
  forward(x);
  backward(x);
  Matrix answer(b.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    for (Eigen::Index k = 0; k < b.rows(); ++k) answer(pattern_->order[k], j) = x(k, j);
  }
  return answer;
}

/// L x = b. What is zero is passed over: of a load on one node all but the supernodes above it.
template <class Scalar>
void SupernodalFactor<Scalar>::forward(Matrix& x) const {
  const int n = static_cast<int>(x.rows()), count = static_cast<int>(x.cols()), step = 1;
  const Scalar one = 1, zero = 0;
  std::vector<Scalar> product;
  for (int s = 0; s < pattern_->supernodes(); ++s) {
    const std::span<const int> rows = pattern_->rows_of(s);
    const int height = static_cast<int>(rows.size()), columns = pattern_->columns(s),
              under = height - columns;
    const Scalar* const l = block(s);
    if ((x.middleRows(pattern_->first[s], columns).array() == 0).all()) continue;
    Scalar* const own = x.data() + pattern_->first[s];
    product.resize(static_cast<std::size_t>(under) * count);
    if (count <= kFew) {
      for (int j = 0; j < count; ++j) {
        Scalar* const column = own + static_cast<std::size_t>(j) * n;
        Blas<Scalar>::trsv("L", "N", "N", &columns, l, &height, column, &step);
        if (under > 0)
          Blas<Scalar>::gemv("N", &under, &columns, &one, l + columns, &height, column, &step, &zero,
                             product.data() + static_cast<std::size_t>(j) * under, &step);
      }
    } else {
      Blas<Scalar>::trsm("L", "L", "N", "N", &columns, &count, &one, l, &height, own, &n);
      if (under > 0)
        Blas<Scalar>::gemm("N", "N", &under, &count, &columns, &one, l + columns, &height, own, &n, &zero,
                           product.data(), &under);
    }
    for (int j = 0; j < count; ++j) {
      Scalar* const column = x.data() + static_cast<std::size_t>(j) * n;
      for (int i = 0; i < under; ++i) column[rows[columns + i]] -= product[j * under + i];
    }
  }
}

/// L^T x = b.
template <class Scalar>
void SupernodalFactor<Scalar>::backward(Matrix& x) const {
  const int n = static_cast<int>(x.rows()), count = static_cast<int>(x.cols()), step = 1;
  const Scalar one = 1, minus = -1;
  std::vector<Scalar> below;
  for (int s = pattern_->supernodes() - 1; s >= 0; --s) {
    const std::span<const int> rows = pattern_->rows_of(s);
    const int height = static_cast<int>(rows.size()), columns = pattern_->columns(s),
              under = height - columns;
    const Scalar* const l = block(s);
    Scalar* const own = x.data() + pattern_->first[s];
    below.resize(static_cast<std::size_t>(under) * count);
    for (int j = 0; j < count; ++j) {
      const Scalar* const column = x.data() + static_cast<std::size_t>(j) * n;
      for (int i = 0; i < under; ++i) below[j * under + i] = column[rows[columns + i]];
    }
    if (count <= kFew) {
      for (int j = 0; j < count; ++j) {
        Scalar* const column = own + static_cast<std::size_t>(j) * n;
        if (under > 0)
          Blas<Scalar>::gemv("T", &under, &columns, &minus, l + columns, &height,
                             below.data() + static_cast<std::size_t>(j) * under, &step, &one, column, &step);
        Blas<Scalar>::trsv("L", "T", "N", &columns, l, &height, column, &step);
      }
    } else {
      if (under > 0)
        Blas<Scalar>::gemm("T", "N", &columns, &count, &under, &minus, l + columns, &height, below.data(),
                           &under, &one, own, &n);
      Blas<Scalar>::trsm("L", "L", "T", "N", &columns, &count, &one, l, &height, own, &n);
    }
  }
}

template class SupernodalFactor<double>;
template class SupernodalFactor<float>;

}  // namespace palpate::sim
