#include "common/contact/simplex_distance.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>

namespace palpate {
namespace {

constexpr double kParallel = 1e-12;  // sine squared of the angle: below, two segments count as parallel

ClosestPoint corner(int i) noexcept {
  ClosestPoint point{{0, 0, 0}, 1};
  point.weight[static_cast<std::size_t>(i)] = 1;
  return point;
}

/// Returns the point on the edge from corner i to corner j, at `along` of its length from i.
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
    const double entire = (d4 - d3) + (d5 - d6);
    return edge(1, 2, entire == 0 ? 0 : (d4 - d3) / entire);
  }
  const double sum = va + vb + vc;
  return {{va / sum, vb / sum, vc / sum}, 3};
}

ClosestPair closest_pair(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) noexcept {
  const auto fraction = [](double part, double entire) {
    return entire > 0 ? std::clamp(part / entire, 0.0, 1.0) : 0.0;
  };
  const Vec3 first = q - p, second = b - a, r = p - a;
  const double f = first.squaredNorm(), e = second.squaredNorm(), mixed = first.dot(second);
  const double along_first = first.dot(r), along_second = second.dot(r), denominator = f * e - mixed * mixed;
  double s = 0;
  if (denominator > kParallel * f * e) {
    s = fraction(mixed * along_second - along_first * e, denominator);
  } else {
    s = 0.5 * (fraction(-along_first, f) + fraction(mixed - along_first, f));
  }
  const double t = fraction(mixed * s + along_second, e);
  return {fraction(mixed * t - along_first, f), t};
}

NearestOnSegment nearest_on_segment(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b,
                                    const Vec3& c) noexcept {
  const Vec3 normal = (b - a).cross(c - a);
  const double from = normal.dot(p - a), to = normal.dot(q - a);
  if (from * to < 0) {
    const double fraction = from / (from - to);
    const Vec3 x = p + fraction * (q - p);
    if (closest_point(x, a, b, c).feature_size == 3) return {0, fraction, x};
  }
  const auto of_end = [&](const Vec3& end, double fraction) -> NearestOnSegment {
    const auto w = closest_point(end, a, b, c).weight;
    return {(end - w[0] * a - w[1] * b - w[2] * c).norm(), fraction, w[0] * a + w[1] * b + w[2] * c};
  };
  const auto of_edge = [&](const Vec3& u, const Vec3& v) -> NearestOnSegment {
    const ClosestPair pair = closest_pair(p, q, u, v);
    return {(p + pair.on_first * (q - p) - u - pair.on_second * (v - u)).norm(), pair.on_first,
            u + pair.on_second * (v - u)};
  };
  return std::min({of_end(p, 0), of_end(q, 1), of_edge(a, b), of_edge(b, c), of_edge(c, a)},
                  [](const auto& one, const auto& other) { return one.distance < other.distance; });
}

double segment_triangle_distance(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b,
                                 const Vec3& c) noexcept {
  return nearest_on_segment(p, q, a, b, c).distance;
}

SimplexHessian distance_hessian(std::span<const Vec3> x, std::span<const double> weight, const Vec3& normal,
                                double distance, WeightGradient* weights,
                                const SlidingPoint* sliding) noexcept {
  const int m = static_cast<int>(x.size());
  const Mat3 across = (Mat3::Identity() - normal * normal.transpose()) / distance;
  // rho = sum_j a_j y_j = distance * normal, with y = (x_0 .. x_(m-1), p).
  const double fraction = sliding != nullptr ? sliding->fraction : 1.0;
  const auto a = [&](int j) { return j == m ? fraction : -weight[static_cast<std::size_t>(j)]; };
  SimplexHessian h = SimplexHessian::Zero();
  for (int j = 0; j <= m; ++j) {
    for (int l = 0; l <= m; ++l) h.block<3, 3>(3 * j, 3 * l) = a(j) * a(l) * across;
  }
  if (weights != nullptr) weights->setZero();
  if (m == 1 && sliding == nullptr) return h;
  // Free weights b_1 .. b_(m-1), b_0 = 1 - their sum, and last the distance of the sliding point: d rho =
  // -e_l db_l, with edges e_l = x_l - x_0 at right angles to the normal, as minus the axis is.
  std::array<Vec3, 2> e;
  int free = 0;
  Eigen::Matrix<double, 12, 2> mixed = Eigen::Matrix<double, 12, 2>::Zero();
  for (int l = 1; l < m; ++l, ++free) {
    e[free] = x[static_cast<std::size_t>(l)] - x[0];
    for (int j = 0; j <= m; ++j) mixed.block<3, 1>(3 * j, free) = -a(j) * (across * e[free]);
    mixed.block<3, 1>(3 * l, free) -= normal;
    mixed.block<3, 1>(0, free) += normal;
  }
  if (sliding != nullptr) {
    e[free] = -sliding->axis;
    for (int j = 0; j <= m; ++j) mixed.block<3, 1>(3 * j, free) = -a(j) * (across * e[free]);
    if (sliding->pivots) mixed.block<3, 1>(3 * m, free) += normal;
    ++free;
  }
  Eigen::Matrix2d curvature = Eigen::Matrix2d::Identity();
  for (int l = 0; l < free; ++l) {
    for (int k = 0; k < free; ++k) curvature(l, k) = e[l].dot(across * e[k]);
  }
  h -= mixed * curvature.inverse() * mixed.transpose();
  if (weights != nullptr) {
    const Eigen::Matrix<double, 2, 12> follow = -curvature.inverse() * mixed.transpose();
    for (int l = 1; l < m; ++l) weights->row(l) = follow.row(l - 1);
    weights->row(0) = -weights->row(1) - weights->row(2);
  }
  return h;
}

}  // namespace palpate
