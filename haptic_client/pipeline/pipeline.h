#pragma once
#include <memory>

#include "common/doubt.h"
#include "common/histogram.h"
#include "common/workspace.h"
#include "haptic_client/device/device.h"
#include "haptic_client/extrapolation/force_estimate.h"
#include "haptic_client/extrapolation/surface_model.h"
#include "haptic_client/pipeline/page_pace.h"
#include "haptic_client/safety/limiter.h"
#include "haptic_client/safety/passivity.h"
#include "haptic_client/safety/rendered_fraction.h"
#include "haptic_client/safety/watchdog.h"
#include "protocol/messages.h"

namespace palpate::client {

/// Returns the part of a message that a law may use. `model`: of the surface, updated to the version that the
/// message announces; may be null.
Sample sample_of(const protocol::ForceSample& message, SurfaceModel* model = nullptr) noexcept;

/// Result of one tick.
struct TickResult {
  Vec3 f_D = Vec3::Zero();    ///< to the device, N
  Vec3 law_W = Vec3::Zero();  ///< what the law said, N, world
  double gain = 0;            ///< [0, 1], what soft start and fades leave of it; 0 of a force that is off
  protocol::ToolState tool;   ///< to the server
  bool used = false;          ///< `sample` arrived, was newer, and is the newest now
  bool flagged = false;       ///< the server calls its force not settled
  Sample sample{};
  Time step{};                                      ///< that the server spent on it
  std::optional<DiscretisationErrors> errors = {};  ///< of its force, where the server published them
};

/// Sums over a session, for the report.
struct PipelineStats {
  Histogram age_ns;                ///< of the newest sample, each tick that has one
  std::uint64_t samples = 0;       ///< used
  std::uint64_t flagged = 0;       ///< of these, those whose force the server calls not settled
  std::uint64_t strained = 0;      ///< those of tissue strained beyond what its law is meant for
  std::uint64_t unsettled = 0;     ///< ticks that faded for that reason
  std::uint64_t wild = 0;          ///< dropped: over 100 times the largest force
  std::uint64_t overtaken = 0;     ///< dropped: not newer than what was there
  std::uint64_t published = 0;     ///< ticks since the first sample
  std::uint64_t stepped_down = 0;  ///< ticks in which a simpler law stood in for the chosen one
  Substitutes substitutes;         ///< which law did
  Time first_published{},
      first_itself{};             ///< of the first tick of `published`, and of the first without a stand-in
  std::uint64_t pages = 0;        ///< of the surface, taken
  std::uint64_t lost = 0;         ///< ticks in which the device gave nothing usable
  std::uint64_t clutched = 0;     ///< ticks
  double max_newton = 0;          ///< largest force written
  double path_m = 0, path_s = 0;  ///< of the tool, world
  double max_speed = 0;           ///< m/s, of the filtered velocity
  double sample_path_m = 0;       ///< sum of |P_n - P_(n-1)|
  double sample_path_s = 0;       ///< and of t_n - t_(n-1)
  std::uint64_t sample_pairs = 0;
};

/// The whole tick, from device reading to device force, as a function of its arguments and its state:
/// workspace -> extrapolator -> passivity -> watchdog -> limiter. No clock, socket or device inside; nothing
/// allocates, locks or throws. Haptic thread only.
///
/// A tick has two halves. `sense` makes the tool state that travels; `render` makes the force from nothing
/// but that tool state and the samples. So a capture, which holds both, replays to the same forces.
class Pipeline {
 public:
  /// `blend`: see `ForceEstimate`.
  Pipeline(std::unique_ptr<Extrapolator> law, const Workspace& workspace, const Limiter::Settings& limits,
           const Passivity::Settings& passivity = {}, double blend = 0)
      : estimate_(std::move(law), blend), workspace_(workspace), passivity_(passivity), limiter_(limits) {
    set_request(estimate_.request());
  }

  /// Asks the server for these parts of a sample, too: laws in the shadow use them. Before the first tick.
  void set_request(const Request& request);

  /// Runs one tick. `arrived`: the newest sample, if one came since the last tick, else null; `pages` of the
  /// surface that came since.
  TickResult tick(const DeviceReading& reading, const protocol::ForceSample* arrived,
                  std::span<const protocol::SurfacePage> pages = {}) noexcept {
    return render(sense(reading), arrived, pages);
  }

  /// Device -> world. Position and filtered velocity stay as they were while the device gives nothing usable.
  protocol::ToolState sense(const DeviceReading& reading) noexcept;

  /// The force for a tool there. Of `tool`, everything is used but `newest_sample`, `pages_taken` and what is
  /// asked for (which the result holds).
  TickResult render(const protocol::ToolState& tool, const protocol::ForceSample* arrived,
                    std::span<const protocol::SurfacePage> pages = {}) noexcept;

  /// The simulation is paused: the force fades as that of an old sample does, and then the clutch is held.
  bool paused() const noexcept { return paused_; }
  const Workspace& workspace() const noexcept { return workspace_; }

  /// Bounds the pages that are requested to what the link leaves for them, pages a second; below 0: no bound.
  void bound_pages(double pages_hz) noexcept { pace_.bound(pages_hz); }

  /// Asks the next tick to clear a latched fault; the force then rises again over a soft start.
  void rearm() noexcept { rearm_requested_ = true; }

  /// Age of the newest sample at the last tick, ns; -1 before there is one. In a pause, of the newest that
  /// said so.
  std::int64_t age_ns() const noexcept;
  /// Why the force fades though samples come: too many are flagged (`Watchdog::doubtful`). None: it does not.
  std::optional<Doubt> doubt() const noexcept;
  const Limiter& limiter() const noexcept { return limiter_; }
  const Watchdog& watchdog() const noexcept { return watchdog_; }
  const Passivity& passivity() const noexcept { return passivity_; }
  /// The simpler law that stands in for the chosen one; empty: none does.
  std::string_view substitute() const noexcept { return estimate_.substitute(); }
  const RenderedFraction& rendered_fraction() const noexcept { return rendered_fraction_; }
  /// The law's force of the last tick before the safety chain, N, device frame.
  double law_newton() const noexcept { return law_newton_; }
  const PipelineStats& stats() const noexcept { return stats_; }

 private:
  bool take(const protocol::ForceSample& arrived, const Vec3& p_W, Time now) noexcept;
  Vec3 safe(const Vec3& f_W, const protocol::ToolState& tool, double dt) noexcept;
  Watchdog::Ruling rule_by_age(const protocol::ToolState& tool, double dt) noexcept;
  void request_pages(protocol::ToolState& tool, Time now) noexcept;
  void follow_path(const protocol::ToolState& tool, double dt) noexcept;

  ForceEstimate estimate_;
  Request request_;
  std::unique_ptr<SurfaceModel> model_;  // null: no law wants it
  PagePace pace_;
  Time requested_{};  // for pages
  Time lead_{};       // from reading the device to the middle of the use of its force
  Workspace workspace_;
  Passivity passivity_;
  Watchdog watchdog_;
  double fade_damping_ = 0;  // N s/m
  Limiter limiter_;
  RenderedFraction rendered_fraction_;
  double law_newton_ = 0;
  protocol::ToolState sensed_;    // tick 0: none yet
  protocol::ToolState rendered_;  // tick 0: none yet
  bool rearm_requested_ = false, paused_ = false;
  bool placed_ = false;        // the device has said once where it is
  std::int64_t heard_ns_ = 0;  // when a sample last came, of a pause, too
  std::uint32_t doubts_ = 0;   // flags of the newest flagged sample
  PipelineStats stats_;
};

}  // namespace palpate::client
