#pragma once
#include <array>
#include <span>

#include "common/types.h"

namespace palpate {

/// The point of a triangle closest to a given point, with the feature it lies on.
struct ClosestPoint {
  std::array<double, 3> weight;  ///< barycentric, >= 0, sum 1; exactly 0 for corners off the feature
  int feature_size;              ///< 1 corner, 2 edge, 3 face
};

/// Closest point to `p` on the triangle (a, b, c), by Voronoi regions (Ericson 2005, section 5.1.5). A
/// triangle without area gives the closest point of one of its edges. As a projection on a convex set it is
/// continuous in `p`.
ClosestPoint closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// Closest points of the segments (p, q) and (a, b), as shares of their lengths from p and from a.
struct ClosestPair {
  double on_first, on_second;
};

/// Computes by clamping (Ericson 2005, section 5.1.9). For parallel segments, takes the middle of the parts
/// that face each other; only there it is not continuous.
ClosestPair closest_pair(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) noexcept;

/// Closest points of a segment (p, q) and a triangle.
struct NearestOnSegment {
  double distance;    ///< m; 0 where they cross
  double on_segment;  ///< share of its length from p
  Vec3 on_triangle;   ///< m
};
NearestOnSegment nearest_on_segment(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b,
                                    const Vec3& c) noexcept;

/// Distance between the segment (p, q) and the triangle (a, b, c), m; 0 where they cross.
double segment_triangle_distance(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b,
                                 const Vec3& c) noexcept;

/// A point on a line that follows p: pivot + share (p - pivot) where it has a pivot, else p + any distance
/// along the axis; the share, or the distance, is free, as the weights b are.
struct SlidingPoint {
  Vec3 axis;        ///< from the pivot to p, or along the axis
  double fraction;  ///< 1 without a pivot
  bool pivots;
};

/// Second derivative of the distance d(x_0 .. x_(m-1), p) between the point p and the affine hull of m = 1..3
/// points, in the order (x_0, .., x_(m-1), p): the first 3 (m + 1) rows and columns are filled.
using SimplexHessian = Eigen::Matrix<double, 12, 12>;
/// First derivative of the weights b (rows) of the closest point of that hull, in the same order.
using WeightGradient = Eigen::Matrix<double, 3, 12>;

/// Computes first and second derivatives of the distance of p from an affine hull. For q = sum b_i x_i the
/// closest point of the hull, d = |p - q| > 0 and n = (p - q) / d, the first derivatives are d_p = n and d_xi
/// = -b_i n (b is optimal, so its variation drops out). The second come from eliminating b from |p - sum b_i
/// x_i|: H = phi_yy - phi_yb phi_bb^-1 phi_by. All lengths in one unit; H in 1/length. b itself moves by
/// -phi_bb^-1 phi_by, which `weights` gets where it is asked for. With `sliding` that point takes the place
/// of p, which it follows; then m <= 2. About 1 us.
SimplexHessian distance_hessian(std::span<const Vec3> x, std::span<const double> weight, const Vec3& normal,
                                double distance, WeightGradient* weights = nullptr,
                                const SlidingPoint* sliding = nullptr) noexcept;

}  // namespace palpate
