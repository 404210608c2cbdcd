#pragma once
#include <cstdint>

#include "common/types.h"

namespace palpate::client {

/// What the last stage before the motors did: ticks; for the faults, how often they switched the force off.
struct LimiterCounts {
  std::uint64_t clamped = 0;  ///< magnitude cut to the limit
  std::uint64_t slewed = 0;   ///< change per tick cut to the limit
  std::uint64_t not_finite = 0, storms = 0;
};

/// Why the force is latched off.
enum class Fault : std::uint8_t {
  kNone,
  kNotFinite,  ///< some stage produced a NaN or an infinity
  kStorm,      ///< the slew limit cut for more than half of a second's time: something oscillates
};

/// The last stage before the motors; there is no way around it. The force that leaves is finite, its
/// magnitude at most `max_force`, and what pushes changes by at most `max_slew` a second; only taking force
/// away and braking are quicker. Pure; haptic thread only.
class Limiter {
 public:
  struct Settings {
    double max_force = 8;   ///< N, (0, 100]
    double max_slew = 160;  ///< N/s, (0, 1e5]: 20 full forces a second
  };
  explicit Limiter(const Settings& settings) : settings_(settings) {}

  /// How much of the force the stages before let through, [0, 1] each.
  struct Shares {
    double fade = 1;     ///< of the watchdog; slewed
    double passive = 1;  ///< of the passivity controller: what it takes away goes at once
  };
  /// `f_D`, the force wished for (N, device frame), clamped, then reduced to its share, then slewed. `dt`
  /// (s): since the last tick; more than 10 ms count as 10, so that a stalled loop does not come back with a
  /// blow.
  Vec3 push(const Vec3& f_D, double dt, const Shares& shares) noexcept;
  /// What leaves: the last `push` and a damper on top of it, which is exempt from the slew limit but not from
  /// the clamp.
  Vec3 finish(const Vec3& damping_D) noexcept;

  /// No force at once, and none to slew from: the device gives nothing usable. Returns zero.
  Vec3 drop() noexcept {
    push_.setZero();
    return push_;
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
  Vec3 push_ = Vec3::Zero();
  double passive_ = 1;    // share of the last tick
  bool clamped_ = false;  // this tick
  Fault fault_ = Fault::kNone;
  LimiterCounts counts_;
  double window_ = 0, slewed_time_ = 0;  // s
};

}  // namespace palpate::client
