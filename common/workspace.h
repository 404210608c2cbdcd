#pragma once
#include <span>
#include <string_view>

#include "common/config.h"

namespace palpate {

/// Pose and scale of the device's workspace in the world: p_W = offset + scale R p_D. The force returns by
/// virtual work, f_D = scale R^T f_W, so that enlarging the motion neither makes nor loses energy.
struct Workspace {
  double scale = 1;              ///< world metres per device metre, (0, 100]
  Vec3 offset_W = Vec3::Zero();  ///< m
  Mat3 axes = Mat3::Identity();  ///< R: rows are the world's axes in the device frame; a rotation
  std::uint16_t clutch = 0;      ///< buttons; while one of them is held, the tool stays and the hand is free

  Vec3 to_world(const Vec3& p_D) const noexcept { return offset_W + scale * axes * p_D; }
  /// Converts a force on the tool (N, world) to the force of the device (N, device frame).
  Vec3 to_device(const Vec3& f_W) const noexcept { return scale * axes.transpose() * f_W; }
  /// Converts a force of the device (N, device frame) to the force on the tool (N, world).
  Vec3 force_to_world(const Vec3& f_D) const noexcept { return axes * f_D / scale; }
  /// Returns the device position (m, device frame) at which the tool is at `p_W` (m).
  Vec3 place_to_device(const Vec3& p_W) const noexcept { return axes.transpose() * (p_W - offset_W) / scale; }
  /// Converts a displacement or a velocity from the world to the device frame.
  Vec3 motion_to_device(const Vec3& d_W) const noexcept { return axes.transpose() * d_W / scale; }
};

/// Returns `axes` of a section: which axis of a device or a file each axis of the world is, such as
/// ["x", "-z", "y"]. Throws `Error` unless that is a rotation.
Mat3 read_rotated_axes(const Config& config);

/// `scale`, `offset` and `axes` of a [workspace] section. Throws `Error`.
Workspace read_workspace(const Config& config);

/// Reach of a device's grip, in its own frame: nowhere outside this box.
struct DeviceReach {
  std::string_view name;  ///< of the device
  Vec3 min, max;          ///< m
};
/// Returns the reach of the devices that have one.
std::span<const DeviceReach> device_reaches();

}  // namespace palpate
