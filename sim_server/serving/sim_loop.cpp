#include "sim_server/serving/sim_loop.h"

#include <algorithm>

#include "common/clock.h"
#include "sim_server/scene/tool_reach.h"

namespace palpate::sim {
namespace {
constexpr Time kPosePollPeriod = std::chrono::microseconds(200);  // rate 0: how often to look for a new pose
// Between two samples of a pause, and two searches of how near a tool is that has not touched yet.
constexpr Time kIdlePeriod = std::chrono::milliseconds(100);
}  // namespace

StepCell& StepCell::operator+=(const StepCell& other) noexcept {
  steps += other.steps;
  step_ns_sum += other.step_ns_sum;
  step_ns_max = std::max(step_ns_max, other.step_ns_max);
  late += other.late;
  return *this;
}

SimLoop::SimLoop(Simulation& simulation, double rate_hz, SimMailboxes& mailboxes,
                 std::span<const ToolSettings> tools, ErrorOfForce& errors, LoopObserver* observer)
    : simulation_(simulation),
      served_(simulation, &errors),
      mailboxes_(mailboxes),
      tools_(tools),
      period_(rate_hz > 0 ? from_seconds(1 / rate_hz) : Time::zero()),
      inputs_(simulation.tools()),
      errors_(errors),
      observer_(observer) {
  stats_.tools.resize(simulation.tools());
  stats_.missed = MissedTools(simulation.tools());
  pass_surfaces_on();
}

void SimLoop::pass_surfaces_on() {
  passed_on_ = served_.published_version();
  for (std::size_t i = 0; i < inputs_.size(); ++i) mailboxes_.tools[i].pager.write(served_.pager(i));
}

double SimLoopStats::max_newton() const noexcept {
  double most = 0;
  for (const ToolStats& tool : tools) most = std::max(most, tool.max_newton);
  return most;
}

void SimLoop::run(const std::stop_token& stop) noexcept {
  Time deadline = now(), last = deadline;
  while (!stop.stop_requested()) {
    const bool fresh = read_inputs();
    const Time start = now();
    LoopTurn done;
    if (period_ > Time::zero() || fresh) {
      done = turn(to_seconds(period_ > Time::zero() ? period_ : start - last));
      last = start;
    }
    done.inputs = inputs_;
    done.late = stats_.late;
    if (observer_ != nullptr) observer_->turned(done);
    deadline += period_ > Time::zero() ? period_ : kPosePollPeriod;
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

/// True if any of them is new.
bool SimLoop::read_inputs() noexcept {
  bool any = false;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    inputs_[i].fresh = mailboxes_.tools[i].input.read(inputs_[i]);
    any = any || inputs_[i].fresh;
  }
  return any;
}

LoopTurn SimLoop::turn(double dt) noexcept {
  const LoopObserver::Leave leave = observer_ != nullptr ? observer_->may_step() : LoopObserver::Leave{};
  if (leave.step) return step(dt, leave.paused);
  report_paused();
  return {};
}

void SimLoop::report_paused() noexcept {
  if (now() < next_published_) return;
  next_published_ = now() + kIdlePeriod;
  bool published = false;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (const auto sample = served_.paused(i, inputs_[i])) {
      mailboxes_.tools[i].force.write({inputs_[i].session, *sample});
      published = true;
    }
  }
  if (published) mailboxes_.bell.ring();
}

LoopTurn SimLoop::step(double dt, bool paused) noexcept {
  const Time start = now();
  const auto outcomes = served_.step(inputs_, dt);
  if (outcomes.empty()) return {};
  if (served_.published_version() != passed_on_) pass_surfaces_on();
  const Time took = now() - start;
  count(outcomes, start, took);
  bool answered = false;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i].answer) continue;
    ForceOutput output{inputs_[i].session, *outcomes[i].answer};
    output.sample.step_ns = took.count();
    if (paused) output.sample.flags |= protocol::ForceSample::kPaused;
    mailboxes_.tools[i].force.write(output);
    answered = true;
  }
  if (answered) mailboxes_.bell.ring();
  return {.inputs = inputs_, .outcomes = outcomes, .start = start, .took = took, .dt = dt};
}

void SimLoop::count_beyond(std::size_t tool) noexcept {
  const SessionInput& input = inputs_[tool];
  const bool lost = (input.state.flags & protocol::ToolState::kDeviceLost) != 0;
  if (input.session == 0 || lost || !tools_[tool].stays_within) return;
  if (!beyond(*tools_[tool].reach, input.state.p_W)) return;
  ++stats_.tools[tool].beyond_steps;
  went_beyond[tool].store(true, std::memory_order_relaxed);
}

void SimLoop::note_cuts() noexcept {
  if (simulation_.resection() == nullptr) return;
  if (simulation_.resection()->totals().time_at_end > 0) cut_to_end.store(true, std::memory_order_relaxed);
}

void SimLoop::count(std::span<const ServedTools::Outcome> outcomes, Time start, Time took) noexcept {
  const auto took_ns = static_cast<double>(took.count());
  bool contact = false, flagged = false;
  double largest = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const ToolForce& force = outcomes[i].force;
    const double newton = force.force.norm();
    ToolStats& tool = stats_.tools[i];
    tool.contact_steps += force.contacts > 0 ? 1 : 0;
    tool.max_newton = std::max(tool.max_newton, newton);
    if (outcomes[i].answer) tool.jumps.add(published_force(*outcomes[i].answer));
    errors_.add_step(i, simulation_.loads(i), newton);
    count_beyond(i);
    contact = contact || force.contacts > 0;
    flagged = flagged || force.flagged;
    largest = std::max(largest, newton);
  }
  stats_.missed.measure(outcomes, simulation_, start + took);
  note_cuts();
  stats_.step_ns.add(took.count());
  stats_.timeline.at(start) += {1, took_ns, took_ns, 0};
  if (contact) stats_.contact_step_ns.add(took.count());
  stats_.flagged += flagged ? 1 : 0;
  newest_newton.store(largest, std::memory_order_relaxed);
  steps_done.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace palpate::sim
