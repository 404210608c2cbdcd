#include "haptic_client/evaluation/observation.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {

SessionCell& SessionCell::operator+=(const SessionCell& other) noexcept {
  errors += other.errors;
  ticks += other.ticks;
  missed += other.missed;
  tick_ns_sum += other.tick_ns_sum;
  tick_ns_max = std::max(tick_ns_max, other.tick_ns_max);
  samples += other.samples;
  step_ns_sum += other.step_ns_sum;
  step_ns_max = std::max(step_ns_max, other.step_ns_max);
  return *this;
}

Observation::Observation(const std::vector<std::string>& laws, double rate_hz, const std::string& where,
                         const Workspace& workspace, std::size_t keep, double blend)
    : scoring_(laws, rate_hz, where, blend), workspace_(workspace), ring_(keep) {}

/// None while nobody holds the tool: the device is lost, the clutch held, or the simulation paused.
std::optional<RenderedForce> Observation::rendered_force(const TickResult& result) const noexcept {
  using protocol::ToolState;
  constexpr auto kNobody = ToolState::kDeviceLost | ToolState::kClutched | ToolState::kInPause;
  if ((result.tool.flags & kNobody) != 0) return {};
  return RenderedForce{.law = result.law_W,
                       .faded = result.gain * result.law_W,
                       .written = workspace_.force_to_world(result.f_D)};
}

void Observation::tick(const TickResult& result, Time took, std::uint64_t missed) noexcept {
  const Time t{result.tool.t_ns};
  SessionCell& cell = timeline_.at(t);
  const auto tick_ns = static_cast<double>(took.count());
  ++cell.ticks;
  cell.missed += static_cast<double>(missed);
  cell.tick_ns_sum += tick_ns;
  cell.tick_ns_max = std::max(cell.tick_ns_max, tick_ns);
  if (result.used) {
    const auto step_ns = static_cast<double>(result.step.count());
    ++cell.samples;
    cell.step_ns_sum += step_ns;
    cell.step_ns_max = std::max(cell.step_ns_max, step_ns);
    if (result.errors) published_errors_.add(*result.errors, result.sample.f.norm());
  }
  const std::optional<RenderedForce> rendered = rendered_force(result);
  scoring_.tick(result.tool.p_W, t, result.used ? &result.sample : nullptr, cell.errors, rendered);
  if (ring_.empty()) return;
  for (const Scoring::ScoredTick& scored : scoring_.newly_scored()) {
    if (recorded_ - scored.number <= ring_.size())
      ring_[scored.number % ring_.size()].reference = scored.reference;
  }
  TickRecord& record = ring_[recorded_++ % ring_.size()];
  record = {result, scoring_.forces()};
  if (rendered) record.written_W = rendered->written;
}

std::optional<double> Observation::total_percent() const noexcept {
  const DiscretisationErrors published = published_errors_.mean();
  const double hand = scoring_.rendered().parts().hand.mean_percent;
  if (!published.mesh.known() || !published.time_step.known() || std::isnan(hand)) return {};
  return hand + static_cast<double>(published.mesh.percent) +
         static_cast<double>(published.time_step.percent);
}

const TickRecord* Observation::leaving() const noexcept {
  return ring_.empty() || recorded_ < ring_.size() ? nullptr : &ring_[recorded_ % ring_.size()];
}

std::vector<TickRecord> Observation::record() const {
  std::vector<TickRecord> all;
  const std::uint64_t size = ring_.size(), first = recorded_ > size ? recorded_ - size : 0;
  for (std::uint64_t i = first; i < recorded_; ++i) all.push_back(ring_[i % size]);
  return all;
}

}  // namespace palpate::client
