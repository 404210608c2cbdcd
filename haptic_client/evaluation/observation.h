#pragma once
#include <vector>

#include "common/error_mean.h"
#include "common/timeline.h"
#include "common/workspace.h"
#include "haptic_client/evaluation/scoring.h"
#include "haptic_client/pipeline/pipeline.h"

namespace palpate::client {

/// Record of one tick, with the forces of the scored laws.
struct TickRecord {
  TickResult result;
  std::array<Vec3, kMaxLaws> laws;     ///< N, world
  std::optional<Vec3> written_W = {};  ///< N, world, on the hand that holds the tool, if one does
  std::optional<Vec3> reference = {};  ///< what was right, N, world; known some samples later
};

/// Cell of the time line of a session.
struct SessionCell {
  ErrorSums errors;
  double ticks = 0, missed = 0, tick_ns_sum = 0, tick_ns_max = 0;
  double samples = 0, step_ns_sum = 0, step_ns_max = 0;  ///< of the server
  SessionCell& operator+=(const SessionCell& other) noexcept;
};
using SessionTimeline = Timeline<SessionCell>;

/// Records of the ticks of a session, live or replayed: scores, a coarse time line, the last ticks. Allocates
/// at construction only. Haptic thread, after the force was written.
class Observation {
 public:
  /// `laws`, `where`: see `Scoring`. `workspace`: of the device. `keep`: how many of the last ticks to keep
  /// (0: none; 3.2 kB each).
  Observation(const std::vector<std::string>& laws, double rate_hz, const std::string& where,
              const Workspace& workspace, std::size_t keep, double blend = 0);

  /// Adds one tick with its `result`; it took `took`, and `missed` deadlines were skipped before it.
  void tick(const TickResult& result, Time took, std::uint64_t missed) noexcept;

  const Scoring& scoring() const noexcept { return scoring_; }
  const SessionTimeline& timeline() const noexcept { return timeline_; }
  const ErrorMeans& published_errors() const noexcept { return published_errors_; }
  /// Returns a bound of the mean error of the force on the hand, from the mesh to the motors, % of the root
  /// mean square of the force that was right: the sum of its parts (triangle inequality). Nothing while one
  /// of them is not known. The error of the tissue's law is not in it.
  std::optional<double> total_percent() const noexcept;
  /// The tick that goes with the next one, as there is no room for more; null: there is.
  const TickRecord* leaving() const noexcept;
  /// The kept ticks, oldest first.
  std::vector<TickRecord> record() const;

 private:
  std::optional<RenderedForce> rendered_force(const TickResult& result) const noexcept;

  Scoring scoring_;
  Workspace workspace_;
  SessionTimeline timeline_;
  ErrorMeans published_errors_;
  std::vector<TickRecord> ring_;
  std::uint64_t recorded_ = 0;
};

}  // namespace palpate::client
