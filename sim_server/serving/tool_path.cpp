#include "sim_server/serving/tool_path.h"

#include <algorithm>

namespace palpate::sim {
namespace {

constexpr std::uint64_t kLongAgo = 1'000'000'000;  // ns

/// Returns the time from an earlier to a later one, whatever they are: a client may send any.
std::uint64_t ns_between(std::int64_t earlier, std::int64_t later) noexcept {
  return static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
}

}  // namespace

ToolPose pose_of(const protocol::ToolState& state) noexcept {
  const auto& [w, x, y, z] = state.q_W;
  const Quat q(w, x, y, z);
  const double size = q.norm();
  return {state.p_W, size > 0.5 && size < 2 ? q.normalized() : Quat::Identity()};
}

void ToolPath::add(const protocol::ToolState& state) noexcept {
  if (written_ > 0 && state.t_ns <= back(0).t_ns) {
    if (ns_between(state.t_ns, back(0).t_ns) < kLongAgo) return;
    written_ = 0;  // the clock of that one was wild
  }
  // The newest is always kept: it takes the place of one that stands too near to the one before.
  if (written_ > 1 && ns_between(back(1).t_ns, back(0).t_ns) < kSpacing) --written_;
  ring_[written_++ % kPoints] = {state.t_ns, pose_of(state), state.v_W};
}

std::optional<ToolPath::Point> ToolPath::at(std::int64_t t_ns) const noexcept {
  const std::size_t known = std::min(written_, kPoints);
  if (known == 0 || t_ns > back(0).t_ns) return {};
  for (std::size_t i = 0; i < known; ++i) {
    const Point& before = back(i);
    if (before.t_ns > t_ns) continue;
    if (before.t_ns == t_ns) return before;
    const Point& after = back(i - 1);
    const double fraction = static_cast<double>(ns_between(before.t_ns, t_ns)) /
                            static_cast<double>(ns_between(before.t_ns, after.t_ns));
    return Point{t_ns,
                 {before.pose.p_W + fraction * (after.pose.p_W - before.pose.p_W),
                  before.pose.q_W.slerp(fraction, after.pose.q_W)},
                 before.v_W + fraction * (after.v_W - before.v_W)};
  }
  return {};
}

}  // namespace palpate::sim
