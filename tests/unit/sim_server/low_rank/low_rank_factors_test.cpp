#include "sim_server/low_rank/low_rank_factors.h"

#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"

using namespace palpate::sim;

namespace {

/// (n x k) with orthonormal columns.
Eigen::MatrixXd orthonormal(Eigen::Index n, Eigen::Index k, std::uint64_t seed) {
  palpate::test::Random random(seed);
  const Eigen::MatrixXd any = Eigen::MatrixXd::NullaryExpr(n, k, [&] { return random.between(-1, 1); });
  return palpate::test::orthonormal(any);
}

/// (90 x 60) with the singular values 1, 1/2, 1/4, ... 2^-19.
Eigen::MatrixXd falling() {
  const Eigen::VectorXd singular =
      Eigen::VectorXd::NullaryExpr(20, [](Eigen::Index k) { return std::ldexp(1.0, -static_cast<int>(k)); });
  return orthonormal(90, 20, 1) * singular.asDiagonal() * orthonormal(60, 20, 2).transpose();
}

}  // namespace

TEST_CASE("low rank: a matrix of known singular values gets as few as the best product of that error has") {
  // Leaving out those from the r-th on changes it by 2^-r sqrt(4/3) (Eckart and Young).
  const Eigen::MatrixXd matrix = falling();
  for (const int rank : {1, 4, 9, 15}) {
    CAPTURE(rank);
    const double tolerance = 1.01 * std::ldexp(std::sqrt(4.0 / 3), -rank);
    const auto found = low_rank_factors(matrix, tolerance);
    REQUIRE(found);
    CHECK(found->left.rows() == found->right.rows());
    CHECK(found->left.rows() >= rank);
    CHECK(found->left.rows() <= rank + 1);  // its columns may leave half of the tolerance
    const Eigen::MatrixXd product = (found->left.transpose() * found->right).cast<double>();
    CHECK((product - matrix).norm() <= tolerance + 1e-6);
  }
}

TEST_CASE("low rank: the error is what was asked for also where the largest numbers are far from equal") {
  // Columns of very different size: a pivot that is not the largest would leave the error to one of them.
  Eigen::MatrixXd matrix = falling();
  for (Eigen::Index c = 0; c < matrix.cols(); ++c)
    matrix.col(c) *= std::pow(10.0, -0.1 * static_cast<double>(c));
  for (const double tolerance : {1e-1, 1e-3, 1e-5}) {
    const auto found = low_rank_factors(matrix, tolerance);
    REQUIRE(found);
    CHECK(((found->left.transpose() * found->right).cast<double>() - matrix).norm() <= tolerance + 1e-6);
  }
}

TEST_CASE(
    "low rank: what is of full rank is no product, and what is within the tolerance of 0 is of rank 0") {
  CHECK_FALSE(low_rank_factors(Eigen::MatrixXd::Identity(12, 30), 0.1));
  CHECK_FALSE(low_rank_factors(orthonormal(40, 40, 3), 1e-3));
  Eigen::MatrixXd not_numbers = falling();
  not_numbers(3, 4) = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(low_rank_factors(not_numbers, 0.1));
  const auto none = low_rank_factors(1e-3 * falling(), 1e-2);
  REQUIRE(none);
  CHECK(none->left.rows() == 0);
  CHECK(none->left.cols() == 90);
  CHECK(none->right.cols() == 60);
  const auto zero = low_rank_factors(Eigen::MatrixXd::Zero(3, 5), 0);
  REQUIRE(zero);
  CHECK(zero->left.rows() == 0);
}
