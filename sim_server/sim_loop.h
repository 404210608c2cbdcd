#pragma once
#include <atomic>
#include <stop_token>

#include "common/doorbell.h"
#include "common/histogram.h"
#include "common/latest_value.h"
#include "common/time.h"
#include "common/timeline.h"
#include "sim_server/served_tool.h"

namespace palpate::sim {

/// The newest force, and for whose session.
struct ForceOutput {
  std::uint64_t session = 0;
  protocol::ForceSample sample;
};

/// Mailboxes between the simulation thread and the network thread. `bell` rings when a force waits.
struct SimMailboxes {
  LatestValue<ToolInput> tool;     // network -> simulation
  LatestValue<ForceOutput> force;  // simulation -> network
  Doorbell bell;
};

/// One stretch of a session.
struct StepCell {
  double steps = 0, step_ns_sum = 0, step_ns_max = 0, late = 0;
  StepCell& operator+=(const StepCell& other) noexcept;
};

/// What the loop measured; read it when the loop has ended.
struct SimLoopStats {
  Timeline<StepCell> timeline;
  Histogram step_ns, contact_step_ns;  ///< all steps, and those in contact
  std::uint64_t late = 0;              ///< deadlines passed over because a step took too long
  std::uint64_t flagged = 0;           ///< steps without a settled answer
  double max_newton = 0;
};

/// Steps the simulation on absolute deadlines: newest tool pose in, newest force out. The only thread that
/// touches the simulation while it runs.
class SimLoop {
 public:
  /// `rate_hz` 0: steps as soon as a new pose is there.
  SimLoop(Simulation& simulation, double rate_hz, SimMailboxes& mailboxes);

  /// Runs until asked to stop.
  void run(const std::stop_token& stop) noexcept;

  const SimLoopStats& stats() const { return stats_; }

  /// Progress for a watching thread: steps done, and the magnitude of the newest force (N).
  std::atomic<std::uint64_t> steps_done{0};
  std::atomic<double> newest_newton{0};

 private:
  void step(double dt) noexcept;
  void count(const ToolForce& force, Time start, Time took) noexcept;

  ServedTool served_;
  SimMailboxes& mailboxes_;
  Time period_;
  ToolInput tool_;
  bool fresh_ = false;
  SimLoopStats stats_;
};

}  // namespace palpate::sim
