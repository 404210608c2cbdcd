#include "sim_server/low_rank/block_low_rank_matrix.h"

#include <numeric>

#include "sim_server/low_rank/point_tiles.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kTolerance = 1e-4;

/// Points of a curved sheet of 0.2 m, in tiles, and how they move one another by Kelvin's solution for a
/// force in an infinite body (1848; Poisson's ratio 0.25), smoothed over 5 mm: W_ij = (a I + d d^T / r^2) /
/// r.
struct Sheet {
  static constexpr int kSide = 20, kPoints = kSide * kSide;
  PointTiles tiles;
  Eigen::MatrixXd exact{3 * kPoints, 3 * kPoints};  // of points in the order of the tiles

  explicit Sheet(int most = 50) {
    std::vector<Vec3> points;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) points.emplace_back(0.01 * i, 0.01 * j, 5e-5 * i * j);
    }
    tiles = tiles_of(points, most);
    for (int i = 0; i < kPoints; ++i) {
      for (int j = 0; j < kPoints; ++j) {
        const Vec3 apart = points[at(i)] - points[at(j)];
        const double r = std::hypot(apart.norm(), 0.005);
        exact.block<3, 3>(3 * i, 3 * j) = (2 * Mat3::Identity() + apart * apart.transpose() / (r * r)) / r;
      }
    }
  }
  std::size_t at(int k) const { return static_cast<std::size_t>(tiles.order[static_cast<std::size_t>(k)]); }
  double smallest() const { return exact.diagonal().minCoeff(); }

  /// Fills `matrix` by tiles in this order, each with all that come after it.
  void give(BlockLowRankMatrix& matrix, const std::vector<int>& order) const {
    for (std::size_t k = 0; k < order.size(); ++k) {
      const int first = tiles.begins[static_cast<std::size_t>(order[k])],
                end = tiles.begins[static_cast<std::size_t>(order[k]) + 1];
      matrix.take(order[k], std::span(order).subspan(k), exact.middleRows(3 * first, 3 * (end - first)));
    }
  }
};

std::vector<int> ascending(int count) {
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

Eigen::MatrixXd dense(const BlockLowRankMatrix& matrix, int points) {
  Eigen::MatrixXd all(3 * points, 3 * points);
  for (int i = 0; i < points; ++i) {
    for (int j = 0; j < points; ++j) all.block<3, 3>(3 * i, 3 * j) = matrix.block(i, j);
  }
  return all;
}

}  // namespace

TEST_CASE(
    "block low rank: each pair of tiles is within the tolerance of what it was given, in half the memory") {
  const Sheet sheet;
  BlockLowRankMatrix matrix(sheet.tiles.begins, kTolerance);
  sheet.give(matrix, ascending(matrix.tiles()));
  const Eigen::MatrixXd found = dense(matrix, Sheet::kPoints);
  CHECK(found == found.transpose());
  const auto& begins = sheet.tiles.begins;
  const double single = 1e-6 * sheet.exact.norm();  // what rounding to single precision may add
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    for (std::size_t j = 0; j + 1 < begins.size(); ++j) {
      const auto part = [&](const Eigen::MatrixXd& of) {
        return of.block(3 * begins[i], 3 * begins[j], 3 * (begins[i + 1] - begins[i]),
                        3 * (begins[j + 1] - begins[j]));
      };
      CHECK((part(found) - part(sheet.exact)).norm() <= kTolerance * sheet.smallest() + single);
    }
  }
  CHECK(static_cast<double>(matrix.bytes()) < 0.5 * static_cast<double>(sheet.exact.size()) * sizeof(float));
  CHECK(matrix.largest_rank() > 0);
  CHECK(matrix.largest_rank() < 75);
}

TEST_CASE(
    "block low rank: loads on several tiles move all points as a dense matrix says, without allocating") {
  const Sheet sheet;
  BlockLowRankMatrix matrix(sheet.tiles.begins, kTolerance);
  std::vector<int> order = ascending(matrix.tiles());
  std::ranges::reverse(order);  // pairs the other way round
  std::swap(order[1], order[4]);
  sheet.give(matrix, order);
  test::Random random(5);
  Eigen::MatrixXd shapes =
      Eigen::MatrixXd::NullaryExpr(3 * Sheet::kPoints, 4, [&] { return random.between(-1, 1); });
  const Eigen::Vector4d weights(0.5, -3, 2, 0.1);
  Eigen::MatrixXd exact = sheet.exact;
  for (const bool added : {false, true}) {
    CAPTURE(added);
    if (added) {
      matrix.add(shapes.leftCols(1), weights.head(1));
      matrix.add(shapes.rightCols(3), weights.tail(3));
      exact += shapes * weights.asDiagonal() * shapes.transpose();
      CHECK((dense(matrix, Sheet::kPoints) - exact).cwiseAbs().maxCoeff() <
            2 * kTolerance * sheet.smallest());
    }
    std::vector<VertexLoad> loads;
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(3 * Sheet::kPoints);
    for (const int point : {0, 3, 399, 120, 121, 3}) {
      loads.push_back({point, random.vector(1)});
      forces.segment<3>(3 * point) += loads.back().force;
    }
    Eigen::VectorXd moved = Eigen::VectorXd::Constant(3 * Sheet::kPoints, 0.25);
    {
      const test::AllocationGuard guard;
      matrix.add_product(loads, moved);
      const Mat3 near = matrix.block(120, 121), far = matrix.block(399, 0);
      CHECK(guard.count() == 0);
      CHECK(near.allFinite());
      CHECK(far.allFinite());
    }
    moved.array() -= 0.25;
    CHECK((moved - exact * forces).cwiseAbs().maxCoeff() < 4 * kTolerance * sheet.smallest() * forces.norm());
  }
}

TEST_CASE("block low rank: what is packed comes back bit by bit, into a matrix of the same tiles alone") {
  const Sheet sheet;
  BlockLowRankMatrix matrix(sheet.tiles.begins, kTolerance);
  sheet.give(matrix, ascending(matrix.tiles()));
  const Eigen::MatrixXd packed = matrix.packed();
  BlockLowRankMatrix other(sheet.tiles.begins, kTolerance);
  REQUIRE(other.unpack(packed));
  CHECK(dense(other, Sheet::kPoints) == dense(matrix, Sheet::kPoints));
  CHECK(other.bytes() == matrix.bytes());
  CHECK(other.packed() == packed);

  BlockLowRankMatrix coarse(Sheet(200).tiles.begins, kTolerance);
  CHECK_FALSE(coarse.unpack(packed.leftCols(1)));
  const Eigen::MatrixXd before = other.packed();
  Eigen::MatrixXd changed = packed;
  changed(4000, 0) = std::numeric_limits<double>::infinity();
  CHECK_FALSE(other.unpack(changed));
  Eigen::MatrixXd longer(packed.rows(), packed.cols() + 1);
  longer << packed, packed.col(0);
  CHECK_FALSE(other.unpack(longer));
  for (const double spoilt : {-2.0, 0.5, 1e300, std::numeric_limits<double>::quiet_NaN(), 151.0}) {
    CAPTURE(spoilt);
    changed = packed;
    changed(1, 0) = spoilt;  // the rank of a pair
    CHECK_FALSE(other.unpack(changed));
  }
  CHECK_FALSE(other.unpack(packed.leftCols(packed.cols() - 1)));
  CHECK_FALSE(other.unpack(Eigen::MatrixXd::Zero(3, 3)));
  CHECK(other.packed() == before);
}

TEST_CASE(
    "block low rank: the error is that of the tile that was taken first, also where the other is stiffer") {
  Sheet sheet;
  const auto& begins = sheet.tiles.begins;
  Eigen::VectorXd stiffer = Eigen::VectorXd::Ones(3 * Sheet::kPoints);
  stiffer.head(3 * begins[1]).setConstant(0.1);  // its compliance a hundredth
  sheet.exact = stiffer.asDiagonal() * sheet.exact * stiffer.asDiagonal();
  for (const int first : {0, 1}) {
    BlockLowRankMatrix matrix(begins, kTolerance);
    std::vector<int> order = ascending(matrix.tiles());
    std::swap(order[0], order[static_cast<std::size_t>(first)]);
    sheet.give(matrix, order);
    const auto wrong = (dense(matrix, Sheet::kPoints) - sheet.exact)
                           .block(0, 3 * begins[1], 3 * begins[1], 3 * (begins[2] - begins[1]))
                           .norm();
    const double softer = sheet.exact(3 * begins[1], 3 * begins[1]), bound = kTolerance * softer;
    CHECK(wrong <= (first == 0 ? 0.01 : 1) * bound + 1e-6 * softer);
    if (first == 1) CHECK(wrong > 0.02 * bound);
  }
}

TEST_CASE("block low rank: one point, and tiles that lie on one another") {
  BlockLowRankMatrix one({0, 1}, kTolerance);
  const Mat3 block = (Mat3() << 3, 1, 0, 1, 2, 0, 0, 0, 1).finished();
  one.take(0, ascending(1), block);
  CHECK(one.block(0, 0) == block);
  CHECK(one.largest_rank() == 0);
  Eigen::MatrixXd product = one.packed();
  product(0, 0) = 1;  // its numbers as a product of rank 1, which would not be symmetric
  CHECK_FALSE(one.unpack(product));

  // Two tiles of two points each, all of which move as one: every pair is of rank 3.
  BlockLowRankMatrix stiff({0, 2, 4}, kTolerance);
  Eigen::MatrixXd rows(6, 12);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 4; ++j) rows.block<3, 3>(3 * i, 3 * j) = block;
  }
  stiff.take(0, ascending(2), rows);
  stiff.take(1, std::vector{1}, rows);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) CHECK((stiff.block(i, j) - block).norm() < 1e-6);
  }
}
