#pragma once
#include <memory>
#include <optional>

#include "common/histogram.h"
#include "haptic_client/device/device.h"
#include "haptic_client/extrapolation/extrapolator.h"
#include "haptic_client/loop/workspace.h"
#include "haptic_client/safety/limiter.h"
#include "haptic_client/safety/watchdog.h"
#include "protocol/messages.h"

namespace palpate::client {

/// What one tick gives.
struct TickResult {
  Vec3 f_D = Vec3::Zero();   ///< to the device, N
  protocol::ToolState tool;  ///< to the server
};

/// Sums over a session, for the report.
struct PipelineStats {
  Histogram age_ns;               ///< of the newest sample, each tick that has one
  std::uint64_t samples = 0;      ///< used
  std::uint64_t overtaken = 0;    ///< dropped: not newer than what was there
  double max_newton = 0;          ///< largest force written
  double path_m = 0, path_s = 0;  ///< of the tool, world
  double max_speed = 0;           ///< m/s, of the filtered velocity
  double sample_path_m = 0;       ///< sum of |P_n - P_(n-1)|
  std::uint64_t sample_pairs = 0;
};

/// The whole tick, from device reading to device force, as a function of its arguments and its state:
/// workspace -> extrapolator -> watchdog -> limiter. No clock, socket or device inside; nothing allocates,
/// locks or throws. Haptic thread only.
class Pipeline {
 public:
  Pipeline(std::unique_ptr<Extrapolator> law, const Workspace& workspace, const Limiter::Settings& limits)
      : law_(std::move(law)), workspace_(workspace), limiter_(limits) {}

  /// One tick. `arrived`: the newest sample, if one came since the last tick, else null.
  TickResult tick(const DeviceReading& reading, const protocol::ForceSample* arrived) noexcept;

  /// Clears a latched fault; the force rises again over a soft start.
  void rearm() noexcept {
    limiter_.rearm();
    watchdog_.restart();
  }
  /// Age of the newest sample at the last tick, ns; -1 before there is one.
  std::int64_t age_ns() const noexcept { return newest_.number == 0 ? -1 : (last_t_ - newest_.t).count(); }
  const Limiter& limiter() const noexcept { return limiter_; }
  const Watchdog& watchdog() const noexcept { return watchdog_; }
  const PipelineStats& stats() const noexcept { return stats_; }

 private:
  void take(const protocol::ForceSample& arrived) noexcept;
  void follow_motion(const DeviceReading& reading, double dt) noexcept;

  std::unique_ptr<Extrapolator> law_;
  Workspace workspace_;
  Watchdog watchdog_;
  Limiter limiter_;
  Sample newest_;  // number 0: none yet
  Time period_{};  // between the two newest samples
  std::uint64_t tick_ = 0;
  Time last_t_{};
  Vec3 p_W_ = Vec3::Zero(), v_W_ = Vec3::Zero();
  PipelineStats stats_;
};

}  // namespace palpate::client
