#pragma once
#include <memory>

#include "haptic_client/evaluation/between_samples.h"
#include "haptic_client/extrapolation/contact_on_patch.h"
#include "haptic_client/extrapolation/organ_motion.h"

namespace palpate::client {

/// Goes with the tool and solves its contact with the model of the surface at every tick, ten times as near
/// as `LocalContact` does, for `BetweenSamples`. Only without friction, and of tissue that does not swing:
/// else force depends on more of the path than what was seen. Haptic thread; only the constructor allocates,
/// 15 MB. 5 to 120 us a tick.
class FollowedContact {
 public:
  explicit FollowedContact(double rate_hz);
  void take(const Sample& sample) noexcept;
  /// Advances to the tool position `p` (m, world) at `t`, as far as the model is known, and returns the
  /// contact there. Calls must be in the order of time.
  std::optional<PathTick::Contact> follow(const Vec3& p, Time t) noexcept;

 private:
  std::unique_ptr<ContactOnPatch> contact_;
  std::optional<Surface> surface_;
  OrganMotion motion_;
  int pause_ = 0;  // ticks
};

}  // namespace palpate::client
