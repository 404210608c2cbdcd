#pragma once
#include <array>
#include <atomic>
#include <span>
#include <stop_token>

#include "common/doorbell.h"
#include "common/histogram.h"
#include "common/latest_value.h"
#include "common/spsc_ring.h"
#include "haptic_client/evaluation/observation.h"
#include "haptic_client/session/heartbeat.h"
#include "haptic_client/session/telemetry_maker.h"

namespace palpate::client {

/// Between the haptic thread and the network thread. Every pose goes out, so that what travels can be
/// replayed tick by tick; of the forces only the newest counts. Pages are asked for by the haptic thread,
/// fewer than there is room for, and no more than `pages_hz` a second (below 0: as many as come without a
/// queue), so that none is requested that the link has no room for. `bell` rings when a pose waits.
struct HapticMailboxes {
  SpscRing<protocol::ToolState> tool{512};     // haptic -> network
  LatestValue<protocol::ForceSample> force;    // network -> haptic
  SpscRing<protocol::SurfacePage> pages{128};  // network -> haptic
  LatestValue<protocol::Pointer> pointer;      // network -> haptic
  std::atomic<double> pages_hz{-1};            // network -> haptic
  SpscRing<protocol::Telemetry> telemetry{4};  // haptic -> network
  Doorbell bell;
};

/// Messages of the network thread that wait for a tick. Haptic thread.
class Arrivals {
 public:
  /// Takes them out of the mailboxes, and tells the pipeline how many pages it may request.
  void take(HapticMailboxes& mailboxes, Pipeline& pipeline) noexcept;
  /// Newest force of the last `take`; null: none came.
  const protocol::ForceSample* sample() const noexcept { return fresh_ ? &sample_ : nullptr; }
  std::span<const protocol::SurfacePage> pages() const noexcept { return std::span(pages_).first(count_); }

 private:
  protocol::ForceSample sample_;
  bool fresh_ = false;
  std::array<protocol::SurfacePage, 32> pages_;
  std::size_t count_ = 0;
};

/// Measurements of the loop; read them when the loop has ended.
struct HapticLoopStats {
  std::uint64_t ticks = 0, missed = 0;
  std::uint64_t unsent = 0;  ///< poses the network thread had no room for
  Histogram period_ns, tick_ns;
};

/// Runs the pipeline on absolute deadlines. A tick that would start more than one period late is missed: its
/// deadline and all others already past are given up, so there are no catch-up bursts.
class HapticLoop {
 public:
  /// `period`: between two ticks, 0.25 to 10 ms.
  HapticLoop(Device& device, Pipeline& pipeline, HapticMailboxes& mailboxes, Observation& observation,
             TelemetryMaker& telemetry, Time period);

  /// Runs until asked to stop; writes zero force last. Haptic thread: allocates, locks, logs and throws
  /// nothing.
  void run(const std::stop_token& stop) noexcept;

  const HapticLoopStats& stats() const { return stats_; }

  /// State for a watching thread.
  std::atomic<double> newest_newton{0};
  std::atomic<std::int64_t> newest_age_ns{-1};  ///< -1: no sample yet
  std::atomic<std::uint64_t> ticks{0}, missed{0};
  std::atomic<Fault> fault{Fault::kNone};
  /// True if less than half of the law's force has been rendered for half a second. The next two are the
  /// law's force (N) and the gain of passivity in the newest tick.
  std::atomic<bool> weak{false};
  std::atomic<double> law_newton{0}, gain{1};
  std::atomic<bool> paused{false};  ///< the simulation is
  static constexpr int kNoDoubt = -1;
  std::atomic<int> doubt{kNoDoubt};  ///< the `Doubt` for which a flagged force fades, if one does
  std::atomic<bool> rearm{false};    ///< set it to clear a latched fault
  Heartbeat* heartbeat = nullptr;    ///< beats at every tick; set it before `run`

 private:
  TickResult tick() noexcept;
  void report(const TickResult& result) noexcept;
  void publish_page(const TickResult& result) noexcept;

  Device& device_;
  Pipeline& pipeline_;
  HapticMailboxes& mailboxes_;
  Observation& observation_;
  TelemetryMaker& telemetry_;
  Time period_;
  Arrivals arrivals_;  // of one tick
  HapticLoopStats stats_;
};

}  // namespace palpate::client
