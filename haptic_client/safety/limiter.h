#pragma once
#include <cstdint>

#include "common/types.h"

namespace palpate::client {

/// Counts of the last stage before the motors: ticks; for the faults, how often they switched the force off.
struct LimiterCounts {
  std::uint64_t clamped = 0;  ///< magnitude cut to the limit
  std::uint64_t slewed = 0;   ///< change per tick cut to the limit
  std::uint64_t not_finite = 0, storms = 0, implausible = 0;
};

/// Why the force is latched off.
enum class Fault : std::uint8_t {
  kNone,
  kNotFinite,  ///< some stage produced a NaN or an infinity
  kStorm,      ///< the slew limit cut for more than half of a second's time: something oscillates
  kExcessive,  ///< more than 100 times the largest force was asked for, half a second long
};

/// The last stage before the motors; there is no way around it. The force that leaves is finite, its
/// magnitude at most `max_force`, and it changes by at most `max_slew` a second in either direction. Only
/// `drop` and `latch` take the force away at once. Pure; haptic thread only.
class Limiter {
 public:
  struct Settings {
    double max_force = 8;  ///< N, (0, 100]
    /// N/s, (0, 1e5]. The largest force takes 4 ms to come or go, as in a stroke of 0.4 m/s into 5 kN/m: an
    /// ordinary stroke does not meet this limit. A limit that it meets is a lag in the loop, which makes
    /// energy (160 N/s did, from 0.2 m/s on a wall of 800 N/m).
    double max_slew = 2000;
  };
  explicit Limiter(const Settings& settings) : settings_(settings) {}

  /// `f`, the law's force, cut to the largest force, direction kept; finite for any finite `f`. Ticks in
  /// which it cuts are counted; half a second in a row of a force that no tissue makes latches. `dt`: as for
  /// `push`.
  Vec3 clamp(const Vec3& f_D, double dt) noexcept;
  /// True if a force (N, any frame) is over 100 times the largest: no tissue makes it.
  bool is_implausible(const Vec3& f) const noexcept;
  /// `f_D` (N) cut to a share of the largest force, direction kept.
  Vec3 within(double fraction, const Vec3& f_D) const noexcept;
  /// `f_D`, the force wished for (N, device frame): clamped, then slewed. `dt` (s): since the last tick; more
  /// than `kLongestTick` counts as that, so that a stalled loop does not come back with a blow.
  Vec3 push(const Vec3& f_D, double dt) noexcept;

  /// No force at once, and none to slew from: the device gives nothing usable, or the clutch is held. Returns
  /// zero.
  Vec3 drop() noexcept {
    push_.setZero();
    return push_;
  }
  /// Switches the force off at once, until `rearm`.
  void latch(Fault fault) noexcept;
  void rearm() noexcept { fault_ = Fault::kNone; }
  /// N.
  double max_force() const noexcept { return settings_.max_force; }
  Fault fault() const noexcept { return fault_; }
  const LimiterCounts& counts() const noexcept { return counts_; }

 private:
  void watch_for_storm(bool slewed, double dt) noexcept;

  Settings settings_;
  Vec3 push_ = Vec3::Zero();
  Fault fault_ = Fault::kNone;
  LimiterCounts counts_;
  double window_ = 0, slewed_time_ = 0, excessive_time_ = 0;  // s
};

}  // namespace palpate::client
