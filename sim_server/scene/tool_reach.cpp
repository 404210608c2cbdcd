#include "sim_server/scene/tool_reach.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::sim {
namespace {

bool meets(const Box& box, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Vec3 min = a.cwiseMin(b).cwiseMin(c), max = a.cwiseMax(b).cwiseMax(c);
  return (max.array() >= box.min.array()).all() && (min.array() <= box.max.array()).all();
}

double distance(const Cone& cone, const Vec3& x) noexcept {
  const Vec3 from = x - cone.apex;
  const double far = from.norm(),
               aside = std::max(
                   0.0, std::atan2(cone.axis.cross(from).norm(), cone.axis.dot(from)) - cone.half_angle);
  if (aside >= std::numbers::pi / 2) return far;
  // In the plane through x and the axis, to the edge of the cone, which is as long as it is deep.
  const double along = std::min(far * std::cos(aside), cone.depth);
  return std::hypot(far * std::sin(aside), far * std::cos(aside) - along);
}

bool meets(const Cone& cone, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Vec3 centre = (a + b + c) / 3;
  const double radius = std::sqrt(
      std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(), (c - centre).squaredNorm()}));
  return distance(cone, centre) <= cone.around + radius;
}

bool outside(const Box& box, const Vec3& p) noexcept {
  return (p.array() < box.min.array()).any() || (p.array() > box.max.array()).any();
}

/// A tip that was drawn out of the body, behind the apex, is where it may be.
bool outside(const Cone& cone, const Vec3& p) noexcept {
  const bool drawn_out = cone.half_angle <= std::numbers::pi / 2 && cone.axis.dot(p - cone.apex) <= 0;
  return !drawn_out && distance(cone, p) > cone.around;
}

Box widened(const Box& box, double by) {
  return {box.min.array() - by, box.max.array() + by};
}

Cone widened(Cone cone, double by) {
  cone.around += by;
  return cone;
}

}  // namespace

Reach widened(const Reach& reach, double by) {
  return std::visit([by](const auto& part) { return Reach(widened(part, by)); }, reach);
}

bool may_touch(const Reach& reach, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  return std::visit([&](const auto& part) { return meets(part, a, b, c); }, reach);
}

bool beyond(const Reach& reach, const Vec3& p_W) noexcept {
  return std::visit([&](const auto& part) { return outside(part, p_W); }, reach);
}

}  // namespace palpate::sim
