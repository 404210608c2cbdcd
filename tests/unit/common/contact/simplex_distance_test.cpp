#include "common/contact/simplex_distance.h"

#include <array>

#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"

using namespace palpate;

TEST_CASE("the closest point of a triangle is nearer than any other of its points") {
  test::Random random(1);
  std::array<int, 4> features{};
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 a = random.vector(1), b = random.vector(1), c = random.vector(1), p = random.vector(2);
    const ClosestPoint closest = closest_point(p, a, b, c);
    const auto& w = closest.weight;
    REQUIRE(w[0] + w[1] + w[2] == Approx(1));
    REQUIRE(std::min({w[0], w[1], w[2]}) >= 0);
    ++features[closest.feature_size];
    const double distance = (p - w[0] * a - w[1] * b - w[2] * c).norm();
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; i + j <= 20; ++j) {
        const Vec3 q = i / 20.0 * a + j / 20.0 * b + (20 - i - j) / 20.0 * c;
        REQUIRE(distance <= (p - q).norm() + 1e-12);
      }
    }
  }
  CHECK(features[1] > 0);
  CHECK(features[2] > 0);
  CHECK(features[3] > 0);
}

namespace {

/// Distance from the last of `y` to the affine hull of the others, by least squares: independent of the
/// program.
double distance_to_hull(const std::vector<Vec3>& y) {
  const auto m = static_cast<int>(y.size()) - 1;
  const Vec3 r = y.back() - y[0];
  if (m == 1) return r.norm();
  Eigen::MatrixXd e(3, m - 1);
  for (int i = 1; i < m; ++i) e.col(i - 1) = y[i] - y[0];
  const Eigen::VectorXd b = test::solve_definite(e.transpose() * e, e.transpose() * r);
  return (r - e * b).norm();
}

}  // namespace

TEST_CASE("the Hessian of the distance to a point, a line and a plane agrees with finite differences") {
  test::Random random(2);
  for (int m = 1; m <= 3; ++m) {
    std::vector<Vec3> y;
    for (int i = 0; i <= m; ++i) y.push_back(random.vector(1));
    // The foot of the perpendicular gives weights and normal.
    std::array<double, 3> weight{1, 0, 0};
    if (m > 1) {
      Eigen::MatrixXd e(3, m - 1);
      for (int i = 1; i < m; ++i) e.col(i - 1) = y[i] - y[0];
      const Eigen::VectorXd b = test::solve_definite(e.transpose() * e, e.transpose() * (y.back() - y[0]));
      weight[0] = 1 - b.sum();
      for (int i = 1; i < m; ++i) weight[i] = b[i - 1];
    }
    Vec3 to = y.back();
    for (int i = 0; i < m; ++i) to -= weight[i] * y[i];
    const SimplexHessian h =
        distance_hessian({y.data(), static_cast<std::size_t>(m)},
                         {weight.data(), static_cast<std::size_t>(m)}, to.normalized(), to.norm());
    constexpr double kStep = 1e-4;
    for (int r = 0; r < 3 * (m + 1); ++r) {
      for (int c = 0; c < 3 * (m + 1); ++c) {
        const auto at = [&](double dr, double dc) {
          auto moved = y;
          moved[r / 3][r % 3] += dr;
          moved[c / 3][c % 3] += dc;
          return distance_to_hull(moved);
        };
        const double difference =
            (at(kStep, kStep) - at(kStep, -kStep) - at(-kStep, kStep) + at(-kStep, -kStep)) /
            (4 * kStep * kStep);
        CHECK(h(r, c) == Approx(difference).margin(1e-5).epsilon(1e-5));
      }
    }
  }
}
