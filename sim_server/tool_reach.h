#pragma once
/// How far a tool gets: by `reach`, a box; by `[tool.workspace]`, what its device can do; or by
/// `[tool.cone]`, where an instrument turns about its trocar. What lies beyond is not built.
#include "common/config.h"
#include "sim_server/scene.h"

namespace palpate::sim {

/// Reads whichever of the three a `[[tool]]` has, after its shape. The last two are of the tool's tip: its
/// own size is added, and 20 mm by which tissue may come nearer as it deforms. Throws `Error`.
void read_reach(const Config& config, ToolSettings& tool);

/// Wider by `by` (m) on all sides.
Reach widened(const Reach& reach, double by);

/// Whether a triangle comes within reach; where that is not plain, true.
bool may_meet(const Reach& reach, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// Whether a tip at p is beyond what its workspace or cone said, by more than was added to them.
bool beyond(const Reach& reach, const Vec3& p_W) noexcept;

}  // namespace palpate::sim
