#include "sim_server/sim_loop.h"

#include <algorithm>

#include "common/clock.h"

namespace palpate::sim {
namespace {
constexpr Time kPollPeriod = std::chrono::microseconds(200);  // rate 0: how often to look for a new pose
}

StepCell& StepCell::operator+=(const StepCell& other) noexcept {
  steps += other.steps;
  step_ns_sum += other.step_ns_sum;
  step_ns_max = std::max(step_ns_max, other.step_ns_max);
  late += other.late;
  return *this;
}

SimLoop::SimLoop(Simulation& simulation, double rate_hz, SimMailboxes& mailboxes)
    : served_(simulation),
      mailboxes_(mailboxes),
      period_(rate_hz > 0 ? from_seconds(1 / rate_hz) : Time::zero()) {}

void SimLoop::run(const std::stop_token& stop) noexcept {
  Time deadline = now(), last = deadline;
  while (!stop.stop_requested()) {
    fresh_ = mailboxes_.tool.read(tool_);
    const Time start = now();
    if (period_ > Time::zero() || fresh_) {
      step(to_seconds(period_ > Time::zero() ? period_ : start - last));
      last = start;
    }
    deadline += period_ > Time::zero() ? period_ : kPollPeriod;
    if (const Time behind = now() - deadline; behind > Time::zero()) {
      if (period_ > Time::zero()) {
        const auto late = static_cast<std::uint64_t>(behind / period_ + 1);
        stats_.late += late;
        stats_.timeline.at(start).late += static_cast<double>(late);
      }
      deadline += behind;
    }
    sleep_until(deadline);
  }
}

void SimLoop::step(double dt) noexcept {
  const Time start = now();
  const auto outcome = served_.step(tool_, fresh_, dt);
  if (!outcome) return;
  const Time took = now() - start;
  count(outcome->force, start, took);
  if (!outcome->answer) return;
  ForceOutput output{tool_.session, *outcome->answer};
  output.sample.step_ns = took.count();
  mailboxes_.force.write(output);
  mailboxes_.bell.ring();
}

void SimLoop::count(const ToolForce& force, Time start, Time took) noexcept {
  const auto took_ns = static_cast<double>(took.count());
  stats_.step_ns.add(took.count());
  stats_.timeline.at(start) += {1, took_ns, took_ns, 0};
  if (force.contacts > 0) stats_.contact_step_ns.add(took.count());
  stats_.flagged += force.flagged ? 1 : 0;
  stats_.max_newton = std::max(stats_.max_newton, force.force.norm());
  newest_newton.store(force.force.norm(), std::memory_order_relaxed);
  steps_done.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace palpate::sim
