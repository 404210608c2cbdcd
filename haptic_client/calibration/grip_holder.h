#pragma once
#include "common/types.h"

namespace palpate::client {

/// Holds the grip of a device at a place, slowly: spring, integral and damper towards a reference that moves
/// at 20 mm/s from where the grip is to its goal, and never runs ahead of the grip by more than 5 mm. So the
/// force builds up over seconds, whatever happens to the grip. Device frame, SI. Pure; haptic thread only.
class GripHolder {
 public:
  /// `max_force`: the most that `push` asks for, N.
  explicit GripHolder(double max_force) : max_force_(max_force) {}

  /// Begins with the grip at `p_D`, without force.
  void begin(const Vec3& p_D) noexcept;
  /// Force (N) that takes the grip from `p_D` to `goal_D`; `dt` (s) since the last call, [0, 0.01].
  Vec3 push(const Vec3& p_D, const Vec3& goal_D, double dt) noexcept;
  /// Force (N) that brakes the grip, as of the last `push`.
  Vec3 damping() const noexcept;

  /// The grip has stayed within 1 mm of its goal for a second.
  bool at_rest() const noexcept { return rest_ >= 1; }
  /// True if the full force of the device was requested for three seconds.
  bool saturated() const noexcept { return saturated_ >= 3; }

 private:
  void watch(const Vec3& p_D, const Vec3& goal_D, double dt) noexcept;

  double max_force_;
  Vec3 reference_, integral_, p_D_, v_D_;
  double rest_ = 0, saturated_ = 0;  // s
};

}  // namespace palpate::client
