#include "sim_server/serving/captured_rerun.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "protocol/session.h"

namespace palpate::sim {
namespace {

constexpr double kLongestStep = 1;  // s between two answers; what was longer was a pause, or another session

/// Exact where they are near; any two, as they come off the wire.
double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  const double about = 1e-9 * (static_cast<double>(to_ns) - static_cast<double>(from_ns));
  return std::abs(about) < 2 * kLongestStep ? 1e-9 * static_cast<double>(to_ns - from_ns) : about;
}

}  // namespace

CapturedRerun::CapturedRerun(Simulation& simulation, double rate_hz)
    : served_(simulation),
      period_(rate_hz > 0 ? to_seconds(from_seconds(1 / rate_hz)) : 0),
      inputs_(simulation.tools()),
      arrived_(simulation.tools()),
      answered_(simulation.tools()),
      captured_(simulation.tools()) {}

void CapturedRerun::take(std::uint64_t session, const protocol::ToolState& state) {
  if (state.tool < arrived_.size()) arrived_[state.tool].push_back({session, state});
}

void CapturedRerun::take(const CapturedAnswer& answer) {
  const std::size_t tool = answer.sample.tool;
  if (tool >= inputs_.size())
    fail("the capture has tool {}, and the scene only {}", tool + 1, inputs_.size());
  if (answer.begins_step) begin_step(answer);
  follow(tool, answer);
  sessions_.insert(tool);
  answered_[tool] = answer.t;
  captured_[tool] = answer.sample.f_W;
}

/// Finds how long the step takes, and goes through those before it that no tool state was new for.
void CapturedRerun::begin_step(const CapturedAnswer& answer) {
  const SessionInput& before = inputs_[answer.sample.tool];
  double dt = seconds_between(before.state.t_ns, answer.state.t_ns);
  if (before.session != answer.session || !(dt > 0 && dt < kLongestStep)) dt = 0;
  dt_ = dt;
  drop_departed(answer.t);
  const bool by_clock = answer.sample.step_ns > 0 && period_ > 0;
  if (by_clock) {
    dt_ = period_;
    // A step that took longer than a period puts off the next.
    const double next = std::max(period_, 1e-9 * static_cast<double>(last_step_ns_));
    const long unanswered = dt > 0 && !answer.after_pause ? std::lround((dt - next) / next) : 0;
    for (long k = 0; k < unanswered; ++k) step();
  }
  last_step_ns_ = by_clock ? answer.sample.step_ns : 0;
}

/// Clients that left, and those that a server drops, as it has not heard of them for so long.
void CapturedRerun::drop_departed(Time t) {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const bool silent = t - answered_[i] > protocol::ServerSessions::kTimeout;
    if (silent || departed_.contains(inputs_[i].session)) inputs_[i].session = 0;
  }
}

/// The path that had arrived when the step began ends at the state that it answered.
void CapturedRerun::follow(std::size_t tool, const CapturedAnswer& answer) {
  SessionInput& input = inputs_[tool];
  std::deque<Arrived>& arrived = arrived_[tool];
  if (input.session != answer.session) input = {};
  input.session = answer.session;
  for (; !arrived.empty(); arrived.pop_front()) {
    const auto& [session, state] = arrived.front();
    if (session == answer.session && state.tick > answer.state.tick) break;
    if (session == answer.session) input.follow(state);
  }
  input.state = answer.state;
  // What a client asks for besides its force changes nothing here.
  input.state.flags &= protocol::ToolState::kDeviceLost;
  input.fresh = true;
}

std::span<const ServedTools::Outcome> CapturedRerun::step() {
  const auto outcomes = served_.step(inputs_, dt_);
  ++steps_;
  simulated_ += dt_;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!inputs_[i].fresh) continue;
    off_ = std::max(off_, (outcomes[i].force.force - captured_[i]).norm());
    largest_ = std::max(largest_, captured_[i].norm());
    inputs_[i].fresh = false;
  }
  return outcomes;
}

}  // namespace palpate::sim
