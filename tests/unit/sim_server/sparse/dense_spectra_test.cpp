#include "sim_server/sparse/dense_spectra.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate::sim;

namespace {

Eigen::MatrixXd drawn(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  palpate::test::Random random(seed);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.between(-1, 1); });
}

double apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm();
}

Eigen::MatrixXd unit(Eigen::Index size) {
  return Eigen::MatrixXd::Identity(size, size);
}

}  // namespace

TEST_CASE(
    "dense spectra: singular values fall, their vectors are orthonormal, and their product is the matrix") {
  for (const auto& [rows, columns] : {std::pair<int, int>{7, 7}, {5, 40}, {40, 5}, {1, 9}, {9, 1}}) {
    CAPTURE(rows, columns);
    const Eigen::MatrixXd a = drawn(rows, columns, 1);
    const auto svd = thin_svd(a);
    REQUIRE(svd);
    const Eigen::Index least = std::min(rows, columns);
    CHECK(apart(svd->left.transpose() * svd->left, unit(least)) < 1e-13);
    CHECK(apart(svd->right_transpose * svd->right_transpose.transpose(), unit(least)) < 1e-13);
    CHECK(apart(svd->left * svd->singular_values.asDiagonal() * svd->right_transpose, a) < 1e-13);
    for (Eigen::Index k = 1; k < least; ++k) CHECK(svd->singular_values[k] <= svd->singular_values[k - 1]);
    CHECK(svd->singular_values[least - 1] >= 0);
  }
}

TEST_CASE("dense spectra: eigenvalues rise, and the matrix times each eigenvector is its multiple") {
  const Eigen::MatrixXd half = drawn(24, 24, 2), a = half + half.transpose();
  Eigen::MatrixXd lower = a;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(1e6);  // is not read
  const auto found = symmetric_spectrum(lower);
  REQUIRE(found);
  CHECK(apart(a * found->vectors, found->vectors * found->values.asDiagonal()) < 1e-12);
  CHECK(apart(found->vectors.transpose() * found->vectors, unit(24)) < 1e-12);
  for (Eigen::Index k = 1; k < 24; ++k) CHECK(found->values[k] >= found->values[k - 1]);
  CHECK(largest_eigenvalue(lower) == Approx(found->values[23]).epsilon(1e-13));
}

TEST_CASE(
    "dense spectra: a pair of matrices has modes that are orthonormal by the second, which is definite") {
  const Eigen::MatrixXd half = drawn(12, 12, 3), a = half + half.transpose(),
                        b = half * half.transpose() + unit(12);
  const auto found = symmetric_spectrum(a, b);
  REQUIRE(found);
  CHECK(apart(a * found->vectors, b * found->vectors * found->values.asDiagonal()) < 1e-11);
  CHECK(apart(found->vectors.transpose() * b * found->vectors, unit(12)) < 1e-12);
  CHECK_FALSE(symmetric_spectrum(a, a));
  CHECK_FALSE(symmetric_spectrum(a, Eigen::MatrixXd::Constant(12, 12, std::nan(""))));
}
