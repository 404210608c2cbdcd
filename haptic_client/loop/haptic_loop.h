#pragma once
#include <atomic>
#include <stop_token>
#include <vector>

#include "common/doorbell.h"
#include "common/histogram.h"
#include "common/latest_value.h"
#include "haptic_client/loop/pipeline.h"

namespace palpate::client {

/// Mailboxes between the haptic thread and the network thread. `bell` rings when a tool state waits.
struct HapticMailboxes {
  LatestValue<protocol::ToolState> tool;     // haptic -> network
  LatestValue<protocol::ForceSample> force;  // network -> haptic
  Doorbell bell;
};

/// One tick as it was, for plots and for replay.
struct TickRecord {
  Time t{};
  Vec3 p_W = Vec3::Zero();
  Vec3 f_D = Vec3::Zero();
  bool fresh = false;  ///< `sample` arrived before this tick
  Sample sample;
};

/// What the loop measured; read it when the loop has ended.
struct HapticLoopStats {
  std::uint64_t ticks = 0, missed = 0;
  Histogram period_ns, tick_ns;
};

/// Runs the pipeline on absolute deadlines. A tick that would start more than one period late is missed: its
/// deadline and all others already past are given up, so there are no catch-up bursts.
class HapticLoop {
 public:
  /// `rate_hz` in [100, 4000]. `record_ticks`: how many of the last ticks to keep (0: none; 200 B each).
  HapticLoop(Device& device, Pipeline& pipeline, HapticMailboxes& mailboxes, double rate_hz,
             std::size_t record_ticks);

  /// Runs until asked to stop; writes zero force last. Haptic thread: allocates, locks, logs and throws
  /// nothing.
  void run(const std::stop_token& stop) noexcept;

  const HapticLoopStats& stats() const { return stats_; }
  /// The recorded ticks, oldest first.
  std::vector<TickRecord> record() const;

  /// For a watching thread.
  std::atomic<double> newest_newton{0};
  std::atomic<std::int64_t> newest_age_ns{-1};  ///< -1: no sample yet
  std::atomic<std::uint64_t> ticks{0}, missed{0};
  std::atomic<Fault> fault{Fault::kNone};
  std::atomic<bool> rearm{false};  ///< set it to clear a latched fault

 private:
  void tick() noexcept;

  Device& device_;
  Pipeline& pipeline_;
  HapticMailboxes& mailboxes_;
  Time period_;
  HapticLoopStats stats_;
  std::vector<TickRecord> ring_;
  std::uint64_t recorded_ = 0;
};

}  // namespace palpate::client
