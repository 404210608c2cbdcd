#pragma once
/// How far a tool gets: by `reach`, a box; by `[tool.workspace]`, what its device can do; or by
/// `[tool.cone]`, where an instrument turns about its trocar. What lies beyond is not built.
#include <variant>

#include "sim_server/scene/regions.h"

namespace palpate::sim {

/// Part of a ball around `apex` within `half_angle` of an axis, closed.
struct Cone {
  Vec3 apex;          ///< m
  Vec3 axis;          ///< unit
  double half_angle;  ///< rad, (0, pi]
  double depth;       ///< m from the apex
  double around = 0;  ///< m: what is no farther from it counts as inside
};

/// Where a tool's surface can get to.
using Reach = std::variant<Box, Cone>;

/// Wider by `by` (m) on all sides.
Reach widened(const Reach& reach, double by);

/// Whether a triangle comes within reach; where that is not plain, true.
bool may_meet(const Reach& reach, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// Whether a tip at p is beyond what its workspace or cone said, by more than was added to them.
bool beyond(const Reach& reach, const Vec3& p_W) noexcept;

}  // namespace palpate::sim
