#include "sim_server/low_rank/block_low_rank_matrix.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "common/parallel.h"
#include "sim_server/low_rank/low_rank_factors.h"

namespace palpate::sim {
namespace {

constexpr double kDense = -1;               // in a file, in place of a rank
constexpr Eigen::Index kPackedRows = 4096;  // of the matrix in a file

std::size_t numbers(const Eigen::MatrixXf& left, const Eigen::MatrixXf& right) {
  return static_cast<std::size_t>(left.size() + right.size());
}

/// Returns the columns of the matrix in a file: two numbers of single precision to one of its own, behind the
/// ranks.
Eigen::Index packed_columns(std::size_t pairs, std::size_t floats) {
  return (static_cast<Eigen::Index>(pairs + (floats + 1) / 2) + kPackedRows - 1) / kPackedRows;
}

/// A rank as a file has it; nothing where it is none that a pair of this size can have.
std::optional<Eigen::Index> rank_of(double published, Eigen::Index most) {
  if (!(published >= 0) || published > static_cast<double>(most) || published != std::floor(published))
    return {};
  return static_cast<Eigen::Index>(published);
}

}  // namespace

BlockLowRankMatrix::BlockLowRankMatrix(std::vector<int> begins, double tolerance)
    : begins_(std::move(begins)), tolerance_(tolerance), pairs_(index(0, tiles())) {
  Eigen::Index largest = 0;
  for (int tile = 0; tile < tiles(); ++tile) {
    tile_of_.resize(static_cast<std::size_t>(begins_[tile + 1]), tile);
    largest = std::max(largest, size(tile));
  }
  sum_.resize(largest);
  part_.resize(largest);
}

/// Returns the index of a pair of tiles, `first` <= `second`.
std::size_t BlockLowRankMatrix::index(int first, int second) {
  return static_cast<std::size_t>(second) * (static_cast<std::size_t>(second) + 1) / 2 +
         static_cast<std::size_t>(first);
}

void BlockLowRankMatrix::take(int tile, std::span<const int> with,
                              const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  const auto block = [&](int other) { return rows.middleCols(3 * begins_[other], size(other)); };
  const double tolerance = tolerance_ * block(tile).diagonal().minCoeff();
  parallel_blocks(with.size(), 1,
                  [&](std::size_t k, std::size_t) { compress(tile, with[k], block(with[k]), tolerance); });
}

void BlockLowRankMatrix::compress(int tile, int other, const Eigen::Ref<const Eigen::MatrixXd>& block,
                                  double tolerance) {
  Pair& pair = pairs_[index(std::min(tile, other), std::max(tile, other))];
  if (tile == other) {
    pair.left = (0.5 * (block + block.transpose())).cast<float>();
  } else if (auto factors = low_rank_factors(block, tolerance)) {
    pair = {true, std::move(factors->left), std::move(factors->right)};
    if (other < tile) std::swap(pair.left, pair.right);
  } else {
    pair.left = block.cast<float>();
    if (other < tile) pair.left.transposeInPlace();
  }
  bytes_ += sizeof(Pair) + numbers(pair.left, pair.right) * sizeof(float);
}

void BlockLowRankMatrix::add(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& weights) {
  const Eigen::Index more = weights.size(), all = signs_.size() + more;
  shapes_.conservativeResize(all, 3 * static_cast<Eigen::Index>(tile_of_.size()));
  shapes_.bottomRows(more) = weights.cwiseAbs().cwiseSqrt().asDiagonal() * shapes.transpose();
  signs_.conservativeResize(all);
  signs_.tail(more) = weights.cwiseSign();
  amplitudes_.resize(all);
}

Mat3 BlockLowRankMatrix::block(int row, int column) const noexcept {
  Mat3 block = tile_of_[row] <= tile_of_[column] ? block_of_pair(row, column)
                                                 : Mat3(block_of_pair(column, row).transpose());
  for (Eigen::Index k = 0; k < signs_.size(); ++k) {
    const Vec3 a = shapes_.block<1, 3>(k, 3 * row).transpose();
    const Eigen::RowVector3d b = signs_[k] * shapes_.block<1, 3>(k, 3 * column);
    block.noalias() += a * b;  // a sign rounds nothing: equal to the transpose of the block across
  }
  return block;
}

Mat3 BlockLowRankMatrix::block_of_pair(int row, int column) const noexcept {
  const int first = tile_of_[row], second = tile_of_[column];
  const Eigen::Index i = 3 * (row - begins_[first]), j = 3 * (column - begins_[second]);
  const Pair& of = pair(first, second);
  if (!of.product) return of.left.block<3, 3>(i, j).cast<double>();
  const Eigen::Matrix3f product = of.left.middleCols<3>(i).transpose().lazyProduct(of.right.middleCols<3>(j));
  return product.cast<double>();
}

void BlockLowRankMatrix::add_product(std::span<const VertexLoad> loads, Eigen::VectorXd& moved) noexcept {
  for (int tile = 0; tile < tiles(); ++tile) {
    const auto on_it = [&](const VertexLoad& load) { return tile_of_[load.vertex] == tile; };
    if (std::ranges::any_of(loads, on_it)) add_of_tile(tile, loads, moved);
  }
  if (signs_.size() == 0) return;
  amplitudes_.setZero();
  for (const VertexLoad& load : loads)
    amplitudes_.noalias() += shapes_.middleCols<3>(3 * static_cast<Eigen::Index>(load.vertex)) * load.force;
  amplitudes_.array() *= signs_.array();
  moved.noalias() += shapes_.transpose() * amplitudes_;
}

/// Adds what the loads on one tile do to all points.
void BlockLowRankMatrix::add_of_tile(int loaded, std::span<const VertexLoad> loads,
                                     Eigen::VectorXd& moved) noexcept {
  const auto for_loads = [&](const auto& work) {
    for (const VertexLoad& load : loads) {
      if (tile_of_[load.vertex] == loaded)
        work(3 * (load.vertex - begins_[loaded]), Eigen::Vector3f(load.force.cast<float>()));
    }
  };
  for (int tile = 0; tile < tiles(); ++tile) {
    const bool is_second = tile > loaded;
    const Pair& of = is_second ? pair(loaded, tile) : pair(tile, loaded);
    auto part = part_.head(size(tile));
    if (of.product) {
      const Eigen::MatrixXf &own = is_second ? of.right : of.left, &other = is_second ? of.left : of.right;
      auto sum = sum_.head(own.rows());
      sum.setZero();
      for_loads([&](Eigen::Index at, const auto& f) { sum.noalias() += other.middleCols<3>(at) * f; });
      part.noalias() = own.transpose() * sum;
    } else if (is_second) {
      part.setZero();
      for_loads([&](Eigen::Index at, const auto& f) {
        part.noalias() += of.left.middleRows<3>(at).transpose() * f;
      });
    } else {
      part.setZero();
      for_loads([&](Eigen::Index at, const auto& f) { part.noalias() += of.left.middleCols<3>(at) * f; });
    }
    moved.segment(3 * begins_[tile], size(tile)) += part.cast<double>();
  }
}

std::size_t BlockLowRankMatrix::bytes() const {
  return bytes_ + static_cast<std::size_t>(shapes_.size() + 2 * signs_.size()) * sizeof(double);
}

Eigen::Index BlockLowRankMatrix::largest_rank() const {
  Eigen::Index largest = 0;
  for (const Pair& pair : pairs_) {
    if (pair.product) largest = std::max(largest, pair.left.rows());
  }
  return largest;
}

Eigen::MatrixXd BlockLowRankMatrix::packed() const {
  std::size_t floats = 0;
  for (const Pair& pair : pairs_) floats += numbers(pair.left, pair.right);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(kPackedRows, packed_columns(pairs_.size(), floats));
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    all.data()[k] = pairs_[k].product ? static_cast<double>(pairs_[k].left.rows()) : kDense;
  auto* to = reinterpret_cast<std::byte*>(all.data() + pairs_.size());
  for (const Pair& pair : pairs_) {
    for (const Eigen::MatrixXf* const part : {&pair.left, &pair.right}) {
      const std::size_t bytes = static_cast<std::size_t>(part->size()) * sizeof(float);
      if (bytes > 0) std::memcpy(to, part->data(), bytes);
      to += bytes;
    }
  }
  return all;
}

bool BlockLowRankMatrix::unpack(const Eigen::Ref<const Eigen::MatrixXd>& packed) {
  const auto doubles = static_cast<std::size_t>(packed.size());
  if (packed.outerStride() != packed.rows() || doubles < pairs_.size()) return false;
  std::vector<Pair> pairs(pairs_.size());
  std::size_t floats = 0;
  for (int second = 0; second < tiles(); ++second) {
    for (int first = 0; first <= second; ++first) {
      const double published = packed.data()[index(first, second)];
      Pair& pair = pairs[index(first, second)];
      pair.product = published != kDense;
      if (pair.product && first == second) return false;
      const auto rank = pair.product ? rank_of(published, std::min(size(first), size(second))) : size(first);
      if (!rank) return false;
      pair.left.resize(*rank, pair.product ? size(first) : size(second));
      if (pair.product) pair.right.resize(*rank, size(second));
      floats += numbers(pair.left, pair.right);
      if ((floats + 1) / 2 > doubles - pairs_.size()) return false;
    }
  }
  if (packed.rows() != kPackedRows || packed.cols() != packed_columns(pairs.size(), floats)) return false;
  const auto* from = reinterpret_cast<const std::byte*>(packed.data() + pairs.size());
  for (Pair& pair : pairs) {
    for (Eigen::MatrixXf* const part : {&pair.left, &pair.right}) {
      const std::size_t bytes = static_cast<std::size_t>(part->size()) * sizeof(float);
      if (bytes > 0) std::memcpy(part->data(), from, bytes);
      if (!part->allFinite()) return false;
      from += bytes;
    }
  }
  pairs_ = std::move(pairs);
  bytes_ = pairs_.size() * sizeof(Pair) + floats * sizeof(float);
  return true;
}

}  // namespace palpate::sim
