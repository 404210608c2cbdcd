#include "sim_server/contact/instant_path.h"

#include <algorithm>

namespace palpate::sim {
namespace {

constexpr double kLongestLead = 0.5;  // of the tool radius: how far ahead of itself a tool is believed to be

}  // namespace

PathPoint InstantPath::at_instant(const ToolInput& input, int instant, int instants) const {
  const bool complete = input.path.size() + 1 == static_cast<std::size_t>(instants);
  if (instant == instants) return {*input.pose, complete ? input.bend : Bend{}};
  if (complete) return input.path[static_cast<std::size_t>(instant) - 1];
  if (!from_) return {*input.pose};  // it appears there
  const double fraction = static_cast<double>(instant) / instants;
  const ToolPose& to = *input.pose;
  return {ToolPose((1 - fraction) * from_->p_W + fraction * to.p_W, from_->q_W.slerp(fraction, to.q_W))};
}

PathPoint InstantPath::ahead_of_instant(const ToolInput& input, int instant, int instants, const Tool& tool) {
  PathPoint point = at_instant(input, instant, instants);
  if (recent_.size() > 2 * kSpacing) recent_.pop_back();
  recent_.insert(recent_.begin(), point.pose);
  if (instant < instants) return at_instant(input, instant + 1, instants);
  const std::size_t spacing = std::min<std::size_t>(kSpacing, (recent_.size() - 1) / 2);
  if (spacing == 0) return point;
  const Vec3 &now = recent_[0].p_W, &before = recent_[spacing].p_W, &first = recent_[2 * spacing].p_W;
  const auto n = static_cast<double>(spacing);
  const Vec3 bend = (now - 2 * before + first) / (n * n), motion = (now - before) / n + (n + 1) / 2 * bend;
  if (motion.norm() <= kLongestLead * tool.radius) point.pose.p_W += motion;
  const double turn = recent_[0].q_W.angularDistance(recent_[1].q_W) * std::max(tool.length, tool.radius);
  if (turn <= kLongestLead * tool.radius)
    point.pose.q_W = (recent_[0].q_W * recent_[1].q_W.conjugate() * recent_[0].q_W).normalized();
  return point;
}

}  // namespace palpate::sim
