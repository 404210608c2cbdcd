#include "sim_server/sim_loop.h"

#include <algorithm>

#include "common/clock.h"

namespace palpate::sim {
namespace {
constexpr Time kPollPeriod = std::chrono::microseconds(200);  // rate 0: how often to look for a new pose
}

SimLoop::SimLoop(Simulation& simulation, double rate_hz, SimMailboxes& mailboxes)
    : simulation_(simulation),
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
      if (period_ > Time::zero()) stats_.late += static_cast<std::uint64_t>(behind / period_ + 1);
      deadline += behind;
    }
    sleep_until(deadline);
  }
}

void SimLoop::step(double dt) noexcept {
  if (tool_.session !=
      session_) {  // in another hand, or nobody's: it does not travel from the one to the other
    simulation_.lift_tool();
    session_ = tool_.session;
    samples_ = 0;
  }
  if (session_ == 0) return;
  const Time start = now();
  const ToolForce force = simulation_.step(tool_.state.p_W, dt);
  const Time took = now() - start;
  stats_.step_ns.add(took.count());
  if (force.contacts > 0) stats_.contact_step_ns.add(took.count());
  stats_.flagged += force.flagged ? 1 : 0;
  stats_.max_newton = std::max(stats_.max_newton, force.force.norm());
  newest_newton.store(force.force.norm(), std::memory_order_relaxed);
  steps_done.fetch_add(1, std::memory_order_relaxed);
  if (fresh_) answer(force, took);  // an old pose deserves no new answer: the client must see its age
}

void SimLoop::answer(const ToolForce& force, Time took) noexcept {
  using protocol::ForceSample;
  const std::uint32_t flags =
      (force.contacts > 0 ? ForceSample::kInContact : 0) | (force.flagged ? ForceSample::kFlagged : 0);
  mailboxes_.force.write({tool_.session,
                          {.tool = tool_.state.tool,
                           .number = ++samples_,
                           .tool_tick = tool_.state.tick,
                           .tool_t_ns = tool_.state.t_ns,
                           .p_W = tool_.state.p_W,
                           .f_W = force.force,
                           .torque_W = Vec3::Zero(),  // every normal passes through the centre of a sphere
                           .step_ns = took.count(),
                           .flags = flags}});
  mailboxes_.bell.ring();
}

}  // namespace palpate::sim
