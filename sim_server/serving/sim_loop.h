#pragma once
#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "common/doorbell.h"
#include "common/histogram.h"
#include "common/latest_value.h"
#include "common/time.h"
#include "common/timeline.h"
#include "sim_server/serving/missed_tools.h"

namespace palpate::sim {

/// The newest force, and for whose session.
struct ForceOutput {
  std::uint64_t session = 0;
  protocol::ForceSample sample;
};

/// The mailboxes of one tool, so that none overtakes what is meant for another.
struct ToolMailboxes {
  LatestValue<SessionInput> input;                   // network -> simulation
  LatestValue<ForceOutput> force;                    // simulation -> network
  LatestValue<std::shared_ptr<SurfacePager>> pager;  // simulation -> network, as seldom as one is made
};

/// Between the simulation thread and the network thread. `bell` rings when forces wait.
struct SimMailboxes {
  std::array<ToolMailboxes, kMaxTools> tools;  // the first ones, as many as the scene has
  Doorbell bell;
};

/// Cell of the time line of a session.
struct StepCell {
  double steps = 0, step_ns_sum = 0, step_ns_max = 0, late = 0;
  StepCell& operator+=(const StepCell& other) noexcept;
};

/// Counts of one tool.
struct ToolStats {
  std::uint64_t contact_steps = 0;
  std::uint64_t beyond_steps = 0;  ///< with its tip beyond its workspace or cone, where nothing is built
  double max_newton = 0;
  UnexplainedJumps jumps{};  ///< between the samples of its sessions
};

/// Measurements of the loop; read them when the loop has ended.
struct SimLoopStats {
  Timeline<StepCell> timeline;
  Histogram step_ns, contact_step_ns;  ///< all steps, and those with a tool in contact
  std::uint64_t late = 0;              ///< deadlines passed over because a step took too long
  std::uint64_t flagged = 0;           ///< steps without a settled answer
  std::vector<ToolStats> tools;
  MissedTools missed;

  /// Largest force on any tool, N.
  double max_newton() const noexcept;
};

/// State of one turn of the loop, for an observer.
struct LoopTurn {
  std::span<const SessionInput> inputs;            ///< of each tool
  std::span<const ServedTools::Outcome> outcomes;  ///< of each tool; empty: no step was made
  Time start{}, took{};                            ///< of the step
  double dt = 0;                                   ///< s, by which it advanced the tissue
  std::uint64_t late = 0;                          ///< deadlines passed over so far
};

/// Somebody who looks on and may hold the steps. Called by the simulation thread: waits for nothing,
/// allocates nothing, throws nothing.
class LoopObserver {
 public:
  virtual ~LoopObserver() = default;
  /// Asked before each step that is due. While it is paused, samples say so ten times a second, and by
  /// the answers to single steps: they let go of their forces.
  struct Leave {
    bool step = true, paused = false;
  };
  virtual Leave may_step() noexcept = 0;
  /// Called at the end of each turn, when the forces are sent.
  virtual void turned(const LoopTurn& turn) noexcept = 0;
};

/// Steps the simulation on absolute deadlines: newest tool poses in, newest forces out. The only thread that
/// touches the simulation while it runs.
class SimLoop {
 public:
  /// `rate_hz` 0: steps as soon as a new pose of any tool is there.
  /// `tools`: of the scene, which outlives this. `errors`: gets each step, and is published.
  /// `observer`: may be null; outlives this.
  SimLoop(Simulation& simulation, double rate_hz, SimMailboxes& mailboxes,
          std::span<const ToolSettings> tools, ErrorOfForce& errors, LoopObserver* observer = nullptr);

  /// Runs until asked to stop.
  void run(const std::stop_token& stop) noexcept;

  const SimLoopStats& stats() const { return stats_; }

  /// Progress for a watching thread: steps done, and the largest force of the newest (N).
  std::atomic<std::uint64_t> steps_done{0};
  std::atomic<double> newest_newton{0};
  std::array<std::atomic<bool>, kMaxTools> went_beyond{};  ///< of each tool, whether it ever was beyond
  std::atomic<bool> cut_to_end{false};  ///< whether a hot tip ever was at tissue that cannot be cut

 private:
  bool read_inputs() noexcept;
  LoopTurn turn(double dt) noexcept;
  LoopTurn step(double dt, bool paused) noexcept;
  void report_paused() noexcept;
  void count_beyond(std::size_t tool) noexcept;
  void note_cuts() noexcept;
  void pass_surfaces_on();
  void count(std::span<const ServedTools::Outcome> outcomes, Time start, Time took) noexcept;

  const Simulation& simulation_;
  ServedTools served_;
  std::uint32_t passed_on_ = 0;  // number of the published surface
  SimMailboxes& mailboxes_;
  std::span<const ToolSettings> tools_;
  Time period_, next_published_{};
  std::vector<SessionInput> inputs_;
  ErrorOfForce& errors_;
  LoopObserver* observer_;
  SimLoopStats stats_;
};

}  // namespace palpate::sim
