#pragma once
/// Reach of a tool: by `reach`, a box; by `[tool.workspace]`, the reach of its device; or by `[tool.cone]`,
/// where an instrument turns about its trocar. Nothing is built beyond it.
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

/// Region that a tool's surface can reach.
using Reach = std::variant<Box, Cone>;

/// Wider by `by` (m) on all sides.
Reach widened(const Reach& reach, double by);

/// Returns true if a triangle comes within reach, and where that is uncertain.
bool may_touch(const Reach& reach, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// True if a tip at p is beyond its workspace or cone, by more than the margin that was added.
bool beyond(const Reach& reach, const Vec3& p_W) noexcept;

}  // namespace palpate::sim
