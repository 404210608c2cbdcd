#pragma once
#include "common/types.h"

namespace palpate::client {

/// A hand on a handle. Defaults: the "typical" operator, 0.3 kg, 2 N s/m in the device, 300 N/m and 10 N s/m
/// in the arm.
struct OperatorSettings {
  double mass = 0.3;            ///< of hand and handle, kg, [0.01, 10]
  double device_damping = 2;    ///< friction of the device, N s/m, [0, 100]
  double hand_stiffness = 300;  ///< of the arm towards where it wants to be, N/m, [0, 1e5]
  double hand_damping = 10;     ///< N s/m, [0, 1e3]
  double max_force = 8;         ///< what the simulated motors give, N, (0, 100]
};

/// A mass that an arm, a spring and a damper, pulls to where it wants to be, and motors push.
class SimulatedHand {
 public:
  /// Starts at rest at `p` (m).
  SimulatedHand(const OperatorSettings& settings, const Vec3& p) : settings_(settings), p_(p) {}

  /// Advances by one substep of `dt` (s), semi-implicit Euler, with the arm's aim at its end (m) and that
  /// aim's velocity.
  void advance(const Vec3& aim, const Vec3& aim_v, double dt) noexcept {
    const Vec3 arm = settings_.hand_stiffness * (aim - p_) + settings_.hand_damping * (aim_v - v_);
    v_ += dt / settings_.mass * (arm + force_ - settings_.device_damping * v_);
    p_ += dt * v_;
  }
  /// Sets the force of the motors, N, until the next call.
  void push(const Vec3& force) noexcept { force_ = force; }
  const Vec3& place() const noexcept { return p_; }

  static constexpr double kSubStep = 0.25e-3;  ///< s, at most
  /// True if substeps of that hand are stable, with a margin. Semi-implicit Euler of a spring k and a damper
  /// c on m is stable where h^2 k / m + 2 h c / m < 4.
  static bool is_stable(const OperatorSettings& hand) noexcept {
    constexpr double kMost = 3;  // of 4: the margin
    return kSubStep * (kSubStep * hand.hand_stiffness + 2 * (hand.hand_damping + hand.device_damping)) <
           kMost * hand.mass;
  }
  static constexpr double kLongest = 0.1;  ///< s between two readings; after more the hand has paused, too

 private:
  OperatorSettings settings_;
  Vec3 p_, v_ = Vec3::Zero(), force_ = Vec3::Zero();
};

}  // namespace palpate::client
