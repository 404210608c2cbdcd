#pragma once
#include <optional>
#include <vector>

#include "sim_server/contact/tool_step.h"

namespace palpate::sim {

/// Path of one tool over the contact instants of its steps. Only the constructor allocates. One thread.
class InstantPath {
 public:
  InstantPath() { recent_.reserve(2 * kSpacing + 1); }

  /// Returns where the tool is at an instant, from 1 to `instants`, of a step with this input, which has a
  /// pose.
  PathPoint at_instant(const ToolInput& input, int instant, int instants) const;
  /// Returns where the tool will be at the instant after this one, which the next call of this passes: after
  /// the last, going on along the parabola through where it was lately, half its radius ahead at most. For
  /// models whose force leads.
  PathPoint ahead_of_instant(const ToolInput& input, int instant, int instants, const Tool& tool);
  /// Ends a step in which the tool went to `to`; absent: it is lifted.
  void end_step(const std::optional<ToolPose>& to) { from_ = to; }
  /// The tool is taken away: it comes from nowhere.
  void clear() {
    from_.reset();
    recent_.clear();
  }
  /// Pose at the end of the step before; absent: the tool was lifted.
  const std::optional<ToolPose>& from() const { return from_; }

 private:
  static constexpr std::size_t kSpacing =
      2;  // instants: how far apart those are that tell where it goes on to

  std::optional<ToolPose> from_;
  std::vector<ToolPose> recent_;  // at the last instants, the newest first
};

}  // namespace palpate::sim
