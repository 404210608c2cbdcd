#include "common/contact/simplex_distance.h"

#include <Eigen/LU>
#include <algorithm>

namespace palpate {
namespace {

ClosestPoint corner(int i) noexcept {
  ClosestPoint point{{0, 0, 0}, 1};
  point.weight[static_cast<std::size_t>(i)] = 1;
  return point;
}

/// On the edge from corner i to corner j, at `along` of its length from i.
ClosestPoint edge(int i, int j, double along) noexcept {
  if (along <= 0) return corner(i);
  if (along >= 1) return corner(j);
  ClosestPoint point{{0, 0, 0}, 2};
  point.weight[static_cast<std::size_t>(i)] = 1 - along;
  point.weight[static_cast<std::size_t>(j)] = along;
  return point;
}

}  // namespace

ClosestPoint closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return corner(0);
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return corner(1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return edge(0, 1, d1 == d3 ? 0 : d1 / (d1 - d3));
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return corner(2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return edge(0, 2, d2 == d6 ? 0 : d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double whole = (d4 - d3) + (d5 - d6);
    return edge(1, 2, whole == 0 ? 0 : (d4 - d3) / whole);
  }
  const double sum = va + vb + vc;
  return {{va / sum, vb / sum, vc / sum}, 3};
}

SimplexHessian distance_hessian(std::span<const Vec3> x, std::span<const double> weight, const Vec3& normal,
                                double distance, WeightGradient* weights) noexcept {
  const int m = static_cast<int>(x.size());
  const Mat3 across = (Mat3::Identity() - normal * normal.transpose()) / distance;
  // rho = sum_j a_j y_j = distance * normal, with y = (x_0 .. x_(m-1), p).
  const auto a = [&](int j) { return j == m ? 1.0 : -weight[static_cast<std::size_t>(j)]; };
  SimplexHessian h = SimplexHessian::Zero();
  for (int j = 0; j <= m; ++j) {
    for (int l = 0; l <= m; ++l) h.block<3, 3>(3 * j, 3 * l) = a(j) * a(l) * across;
  }
  if (weights != nullptr) weights->setZero();
  if (m == 1) return h;
  // Free weights b_1 .. b_(m-1), b_0 = 1 - their sum: edges e_l = x_l - x_0 are at right angles to the
  // normal.
  Eigen::Matrix<double, 12, 2> mixed = Eigen::Matrix<double, 12, 2>::Zero();
  Eigen::Matrix2d curvature = Eigen::Matrix2d::Identity();
  for (int l = 1; l < m; ++l) {
    const Vec3 e = x[static_cast<std::size_t>(l)] - x[0];
    for (int j = 0; j <= m; ++j) mixed.block<3, 1>(3 * j, l - 1) = -a(j) * (across * e);
    mixed.block<3, 1>(3 * l, l - 1) -= normal;
    mixed.block<3, 1>(0, l - 1) += normal;
    for (int k = 1; k < m; ++k) {
      curvature(l - 1, k - 1) = e.dot(across * (x[static_cast<std::size_t>(k)] - x[0]));
    }
  }
  h -= mixed * curvature.inverse() * mixed.transpose();
  if (weights != nullptr) {
    weights->bottomRows<2>() = -curvature.inverse() * mixed.transpose();
    weights->row(0) = -weights->row(1) - weights->row(2);
  }
  return h;
}

}  // namespace palpate
