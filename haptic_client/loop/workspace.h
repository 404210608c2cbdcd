#pragma once
#include "common/types.h"

namespace palpate::client {

/// Where the device's workspace lies in the world: p_W = offset + scale p_D, axes alike. The force goes back
/// by virtual work, f_D = scale f_W, so that enlarging the motion neither makes nor loses energy.
struct Workspace {
  double scale = 1;              ///< world metres per device metre, (0, 100]
  Vec3 offset_W = Vec3::Zero();  ///< m

  Vec3 to_world(const Vec3& p_D) const noexcept { return offset_W + scale * p_D; }
  Vec3 to_device(const Vec3& f_W) const noexcept { return scale * f_W; }
};

}  // namespace palpate::client
