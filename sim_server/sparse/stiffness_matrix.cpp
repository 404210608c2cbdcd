#include "sim_server/sparse/stiffness_matrix.h"

#include <algorithm>
#include <cassert>

namespace palpate::sim {

FreeDofs::FreeDofs(int nodes, const std::vector<int>& fixed) : held(static_cast<std::size_t>(nodes), 0) {
  for (const int node : fixed) held[node] = kAllAxes;
  number();
}

FreeDofs::FreeDofs(std::vector<HeldAxes> held_axes) : held(std::move(held_axes)) {
  number();
}

void FreeDofs::number() {
  first.assign(held.size(), -1);
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == kAllAxes) continue;
    first[i] = count;
    count += 3;
  }
}

void FreeDofs::hold(Eigen::VectorXd& v) const noexcept {
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0 || first[i] < 0) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if ((held[i] >> axis & 1) != 0) v[first[i] + axis] = 0;
    }
  }
}

StiffnessMatrix::StiffnessMatrix(const FreeDofs& dofs, std::span<const int> groups,
                                 std::span<const int> first)
    : held_(dofs.held), matrix_(dofs.count, dofs.count) {
  for (const int dof : dofs.first) block_.push_back(dof < 0 ? -1 : dof / 3);
  partly_held_ = std::ranges::any_of(held_, [](HeldAxes h) { return h != 0 && h != kAllAxes; });
  const auto blocks = static_cast<std::size_t>(dofs.count / 3);
  std::vector<std::vector<int>> below(blocks);  // block rows of each block column, from the diagonal down
  for (std::size_t c = 0; c < blocks; ++c) below[c].push_back(static_cast<int>(c));
  for (std::size_t g = 0; g + 1 < first.size(); ++g) {
    for (int i = first[g]; i < first[g + 1]; ++i) {
      for (int j = first[g]; j < first[g + 1]; ++j) {
        const int row = block_[groups[i]], column = block_[groups[j]];
        if (column >= 0 && row > column) below[column].push_back(row);
      }
    }
  }
  for (auto& rows : below) {
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    rows_.insert(rows_.end(), rows.begin(), rows.end());
    rows_start_.push_back(static_cast<int>(rows_.size()));
  }
  matrix_.resizeNonZeros(9 * static_cast<Eigen::Index>(rows_.size()));
  int* const outer = matrix_.outerIndexPtr();
  int* inner = matrix_.innerIndexPtr();
  outer[0] = 0;
  for (std::size_t c = 0; c < blocks; ++c) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int row : below[c]) {
        for (int r = 0; r < 3; ++r) *inner++ = 3 * row + r;
      }
      const auto column = 3 * c + static_cast<std::size_t>(axis);
      outer[column + 1] = outer[column] + 3 * static_cast<int>(below[c].size());
    }
  }
  set_zero();
}

void StiffnessMatrix::set_zero() noexcept {
  std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
}

void StiffnessMatrix::add(int i, int j, const Mat3& block) noexcept {
  if (block_[i] < 0 || block_[j] < 0) return;
  if (!partly_held_ || (held_[i] == 0 && held_[j] == 0)) return add_to(i, j, block);
  Mat3 free = block;
  for (int axis = 0; axis < 3; ++axis) {
    if ((held_[i] >> axis & 1) != 0) free.row(axis).setZero();
    if ((held_[j] >> axis & 1) != 0) free.col(axis).setZero();
  }
  add_to(i, j, free);
}

void StiffnessMatrix::close_empty(double value) noexcept {
  for (Eigen::Index k = 0; k < matrix_.cols(); ++k) {  // the block on the diagonal is the first of its column
    double& diagonal = matrix_.valuePtr()[matrix_.outerIndexPtr()[k] + static_cast<int>(k % 3)];
    if (diagonal == 0) diagonal = value;
  }
}

void StiffnessMatrix::add_to(int i, int j, const Mat3& block) noexcept {
  int row = block_[i], column = block_[j];
  const bool turned = row < column;
  if (turned) std::swap(row, column);
  const std::span<const int> rows =
      std::span(rows_).subspan(rows_start_[column], rows_start_[column + 1] - rows_start_[column]);
  std::ptrdiff_t place = 0;  // counted, as there are few: a search would branch on each
  for (const int other : rows) place += other < row ? 1 : 0;
  assert(rows[place] == row);
  const std::ptrdiff_t length = 3 * static_cast<std::ptrdiff_t>(rows.size());
  double* const value = matrix_.valuePtr() + 9 * static_cast<std::ptrdiff_t>(rows_start_[column]) + 3 * place;
  const Mat3 to_add = turned ? Mat3(block.transpose()) : block;
  for (int c = 0; c < 3; ++c) Eigen::Map<Vec3>(value + c * length) += to_add.col(c);
}

void StiffnessMatrix::add_to_diagonal(std::span<const double> per_node, double factor) noexcept {
  for (std::size_t i = 0; i < block_.size(); ++i) {
    if (block_[i] >= 0)
      add(static_cast<int>(i), static_cast<int>(i), factor * per_node[i] * Mat3::Identity());
  }
}

Eigen::MatrixXd StiffnessMatrix::times(const Eigen::MatrixXd& x) const {
  // By rows, so that the inner loops are over the columns of X.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Rows by = x;
  Rows sum = Rows::Zero(x.rows(), x.cols());
  for (Eigen::Index column = 0; column < matrix_.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix_, column); entry; ++entry) {
      if (entry.row() < column) continue;  // above the diagonal
      sum.row(entry.row()) += entry.value() * by.row(column);
      if (entry.row() > column) sum.row(column) += entry.value() * by.row(entry.row());
    }
  }
  return sum;
}

std::size_t StiffnessMatrix::bytes() const {
  return static_cast<std::size_t>(matrix_.nonZeros()) * (sizeof(double) + sizeof(int)) +
         (static_cast<std::size_t>(matrix_.cols()) + block_.size() + rows_.size() + rows_start_.size()) *
             sizeof(int);
}

}  // namespace palpate::sim
