#pragma once
#include <cstdint>

#include "common/types.h"

namespace palpate::client {

/// What the last stage before the motors did, in ticks (latched: times).
struct LimiterCounts {
  std::uint64_t clamped = 0;  ///< magnitude cut to the limit
  std::uint64_t slewed = 0;   ///< change per tick cut to the limit
  std::uint64_t latched = 0;  ///< a fault switched the force off until re-armed
};

/// Why the force is latched off.
enum class Fault : std::uint8_t {
  kNone,
  kNotFinite,  ///< some stage produced a NaN or an infinity
  kStorm,      ///< the slew limit cut for more than half of a second's time: something oscillates
};

/// The last stage before the motors; there is no way around it. The force that leaves is finite, its
/// magnitude at most `max_force`, and the part of it that is not damping changes by at most `max_slew` a
/// second. Pure; haptic thread only.
class Limiter {
 public:
  struct Settings {
    double max_force = 8;   ///< N, (0, 100]
    double max_slew = 160;  ///< N/s, (0, 1e5]: 20 full forces a second
  };
  explicit Limiter(const Settings& settings) : settings_(settings) {}

  /// `f_D`: the force wished for (N, device frame); `damping_D`: a damper's share on top of it, exempt from
  /// the slew limit but not from the clamp. `dt` (s): since the last tick; more than 10 ms count as 10, so
  /// that a stalled loop does not come back with a blow.
  /// `gain` in [0, 1] fades the force after the clamp, so that a wild one fades as a full one does.
  Vec3 limit(const Vec3& f_D, const Vec3& damping_D, double dt, double gain = 1) noexcept;

  /// No force at once, and none to slew from: the device gives nothing usable. Returns zero.
  Vec3 drop() noexcept {
    last_.setZero();
    return last_;
  }
  /// Switches the force off at once, until `rearm`.
  void latch(Fault fault) noexcept;
  void rearm() noexcept { fault_ = Fault::kNone; }
  Fault fault() const noexcept { return fault_; }
  const LimiterCounts& counts() const noexcept { return counts_; }

 private:
  /// `f` cut to the largest force, direction kept; finite for any finite `f`.
  Vec3 within_magnitude(const Vec3& f) const noexcept;
  void watch_for_storm(bool slewed, double dt) noexcept;

  Settings settings_;
  Vec3 last_ = Vec3::Zero();
  Fault fault_ = Fault::kNone;
  LimiterCounts counts_;
  double window_ = 0, slewed_time_ = 0;  // s
};

}  // namespace palpate::client
