#pragma once
#include <span>
#include <string_view>

#include "common/config.h"

namespace palpate {

/// Where the device's workspace lies in the world: p_W = offset + scale R p_D. The force goes back by virtual
/// work, f_D = scale R^T f_W, so that enlarging the motion neither makes nor loses energy.
struct Workspace {
  double scale = 1;              ///< world metres per device metre, (0, 100]
  Vec3 offset_W = Vec3::Zero();  ///< m
  Mat3 axes = Mat3::Identity();  ///< R: rows are the world's axes in the device frame; a rotation
  std::uint16_t clutch = 0;      ///< buttons; while one of them is held, the tool stays and the hand is free

  Vec3 to_world(const Vec3& p_D) const noexcept { return offset_W + scale * axes * p_D; }
  /// Of a force.
  Vec3 to_device(const Vec3& f_W) const noexcept { return scale * axes.transpose() * f_W; }
  /// Of a force that the device gives.
  Vec3 force_to_world(const Vec3& f_D) const noexcept { return axes * f_D / scale; }
  /// Where the device must be for the tool to be at `p_W`.
  Vec3 place_to_device(const Vec3& p_W) const noexcept { return axes.transpose() * (p_W - offset_W) / scale; }
  /// Of a displacement or a velocity.
  Vec3 motion_to_device(const Vec3& d_W) const noexcept { return axes.transpose() * d_W / scale; }
};

/// `scale`, `offset` and `axes` of a [workspace] section. Throws `Error`.
Workspace read_workspace(const Config& config);

/// Where a device can take its grip, in its own frame: nowhere outside this box.
struct DeviceReach {
  std::string_view name;  ///< of the device
  Vec3 min, max;          ///< m
};
/// Of the devices that have one.
std::span<const DeviceReach> device_reaches();

}  // namespace palpate
