#pragma once
#include <Eigen/Core>
#include <atomic>
#include <span>
#include <vector>

#include "common/contact/vertex_load.h"

namespace palpate::sim {

/// A symmetric matrix W (3n x 3n) of 3 x 3 blocks, one for each pair of n points that lie in tiles of
/// neighbours: block low-rank (Amestoy et al. 2015), each tile on the diagonal dense, each pair of tiles as a
/// product of thin matrices (`LowRankFactors`) where that takes less. In single precision. What is given of a
/// pair of tiles is kept, in Frobenius' norm, to `tolerance` times the smallest diagonal number of W in that
/// of the two which `take` got first: loads of root sum square F on one of them move the other by no more
/// than that times F otherwise. Where the second tile is stiffer, that is more of its own compliance.
/// Rounding adds some 1e-7 of the largest numbers of the pair.
class BlockLowRankMatrix {
 public:
  /// `begins`: (tiles + 1) the first point of each tile; last: n. All is 0 as yet.
  BlockLowRankMatrix(std::vector<int> begins, double tolerance);

  int tiles() const { return static_cast<int>(begins_.size()) - 1; }
  std::span<const int> begins() const { return begins_; }

  /// Set-up: takes rows of W (3 points of `tile` x 3n), of which only those columns are looked at that
  /// belong to the tiles `with`; `tile` must be one of them, and each pair of tiles comes once. Called by
  /// several threads at once, of different tiles; on all cores. Allocates.
  void take(int tile, std::span<const int> with, const Eigen::Ref<const Eigen::MatrixXd>& rows);

  /// Adds shapes diag(weights) shapes^T; shapes: (3n x k), in double precision. Set-up.
  void add(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& weights);

  /// Block of two points. No allocation. O(rank + k).
  Mat3 block(int row, int column) const noexcept;
  /// Adds W f to `moved` (3n). One thread; no allocation. O(n (rank x loaded tiles + k)).
  void add_product(std::span<const VertexLoad> loads, Eigen::VectorXd& moved) noexcept;

  /// Numbers, and what describes them.
  std::size_t bytes() const;
  /// Largest rank of a pair of tiles that is a product.
  Eigen::Index largest_rank() const;

  /// Returns the matrix without what was added, in one matrix, for a file.
  Eigen::MatrixXd packed() const;
  /// Takes what `packed` made of a matrix with the same tiles. False, and nothing is changed, where it is
  /// none.
  bool unpack(const Eigen::Ref<const Eigen::MatrixXd>& packed);

 private:
  /// Block of two tiles, rows of the first and columns of the second.
  struct Pair {
    bool product = false;
    Eigen::MatrixXf left;   // product: (rank x 3 points of the first), else the block itself
    Eigen::MatrixXf right;  // product: (rank x 3 points of the second)
  };

  Eigen::Index size(int tile) const { return 3 * (begins_[tile + 1] - begins_[tile]); }
  const Pair& pair(int first, int second) const { return pairs_[index(first, second)]; }
  static std::size_t index(int first, int second);
  void compress(int tile, int other, const Eigen::Ref<const Eigen::MatrixXd>& block, double tolerance);
  Mat3 block_of_pair(int row, int column) const noexcept;
  void add_of_tile(int loaded, std::span<const VertexLoad> loads, Eigen::VectorXd& moved) noexcept;

  std::vector<int> begins_;
  std::vector<int> tile_of_;  // (n)
  double tolerance_;
  std::vector<Pair> pairs_;             // of tiles, first <= second
  std::atomic<std::size_t> bytes_ = 0;  // of the pairs
  Eigen::MatrixXd shapes_{0, 0};        // (k x 3n) times the roots of their weights
  Eigen::VectorXd signs_, amplitudes_;  // (k) of the weights; scratch
  Eigen::VectorXf sum_, part_;          // scratch of `add_product`: of a rank, of a tile
};

}  // namespace palpate::sim
