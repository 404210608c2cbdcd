#include "sim_server/serving/served_tools.h"

#include <algorithm>
#include <cassert>

#include "common/time.h"
#include "sim_server/serving/surface_pager.h"

namespace palpate::sim {
using protocol::ForceSample;

namespace {

constexpr double kLongestBend = 0.1;  // s between two states; after more, velocities tell nothing of the way
constexpr double kFarthestAhead = 2e-3;  // m; facts of the study: without a cap, fast tools fare worse

protocol::Linearisation on_the_wire(const Simulation::Linearised& l) noexcept {
  const Mat3 k = 0.5 * (l.tangent + l.tangent.transpose());  // of friction, the part that stores energy
  return {.tangent = {k(0, 0), k(0, 1), k(0, 2), k(1, 1), k(1, 2), k(2, 2)},
          .normal_W = l.plane.normal_W,
          .gap = l.plane.gap};
}

/// Of what came over the wire; an orientation that is none is taken for no turn.
ToolPose pose_of(const protocol::ToolState& state) noexcept {
  const auto& [w, x, y, z] = state.q_W;
  const Quat q(w, x, y, z);
  const double size = q.norm();
  return {state.p_W, size > 0.5 && size < 2 ? q.normalized() : Quat::Identity()};
}

/// How a tool went from one state to the next, by its velocities and its own clock.
Bend bend_between(const protocol::ToolState& before, const protocol::ToolState& now) noexcept {
  const double dt = 1e-9 * (static_cast<double>(now.t_ns) - static_cast<double>(before.t_ns));
  if (!(dt > 0 && dt < kLongestBend)) return {};
  const Vec3 way = now.p_W - before.p_W;
  return {dt * before.v_W - way, dt * now.v_W - way};
}

}  // namespace

ServedTools::ServedTools(Simulation& simulation)
    : simulation_(simulation),
      holders_(simulation.tools()),
      places_(simulation.tools()),
      outcomes_(simulation.tools()) {
  for (std::size_t i = 0; i < simulation.tools(); ++i)
    surfaces_.push_back(SurfacePager(simulation, i).state());
}

std::span<const ServedTools::Outcome> ServedTools::step(std::span<const ToolInput> inputs,
                                                        double dt) noexcept {
  assert(inputs.size() == holders_.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].session != holders_[i].session) {
      simulation_.lift_tool(i);  // in another hand, or nobody's: it does not travel from one to the other
      holders_[i] = {.session = inputs[i].session};
    }
    // The pose of a lost device is the last one known, or none: it touches nothing.
    const bool lost = (inputs[i].state.flags & protocol::ToolState::kDeviceLost) != 0;
    simulation_.press_buttons(i, inputs[i].state.buttons);
    simulation_.want_tangent(
        i, inputs[i].fresh && (inputs[i].state.flags & protocol::ToolState::kWantsHere) != 0);
    simulation_.bend_way(i, bend_between(holders_[i].before, inputs[i].state));
    holders_[i].before = inputs[i].state;
    places_[i].reset();
    if (inputs[i].session != 0 && !lost) places_[i] = pose_of(inputs[i].state);
  }
  if (std::all_of(holders_.begin(), holders_.end(), [](const Holder& h) { return h.session == 0; }))
    return {};
  const std::span<const ToolForce> forces = simulation_.step(places_, dt);
  for (std::size_t i = 0; i < inputs.size(); ++i) outcomes_[i] = {forces[i], answer(i, inputs[i], forces[i])};
  return outcomes_;
}

std::optional<ForceSample> ServedTools::answer(std::size_t tool, const ToolInput& input,
                                               const ToolForce& force) noexcept {
  if (input.session == 0 || !input.fresh) return {};
  const std::uint32_t flags =
      (force.contacts > 0 ? ForceSample::kInContact : 0) | (force.flagged ? ForceSample::kFlagged : 0);
  ForceSample sample{.tool = static_cast<std::uint8_t>(tool),
                     .number = ++holders_[tool].samples,
                     .tool_tick = input.state.tick,
                     .tool_t_ns = input.state.t_ns,
                     .p_W = input.state.p_W,
                     .f_W = force.force,
                     .torque_W = force.torque,
                     .flags = flags};
  if (places_[tool] && !force.flagged) add_parts(tool, input.state, force, sample);
  return sample;
}

/// What this tool state asked for beyond the force; nothing is computed that nobody asked for.
void ServedTools::add_parts(std::size_t tool, const protocol::ToolState& state, const ToolForce& force,
                            ForceSample& sample) noexcept {
  if ((state.flags & (protocol::ToolState::kWantsHere | protocol::ToolState::kWantsAhead)) != 0)
    add_tangents(tool, state, force, sample);
  if ((state.flags & protocol::ToolState::kWantsSurface) != 0 && surfaces_[tool].version != 0 &&
      !simulation_.tool(tool).holds()) {  // what is grasped is no matter of contact
    sample.surface = surfaces_[tool];
    sample.surface.shift_W = simulation_.surface_shift(tool, state.p_W);
    sample.flags |= ForceSample::kHasSurface;
  }
}

void ServedTools::add_tangents(std::size_t tool, const protocol::ToolState& state, const ToolForce& force,
                               ForceSample& sample) noexcept {
  const Vec3 surface_v_W = simulation_.surface_velocity(tool, state.p_W);
  if ((state.flags & protocol::ToolState::kWantsHere) != 0) {
    sample.surface_v_W = surface_v_W;
    sample.here = on_the_wire(simulation_.linearise(tool, state.p_W, &force));
    sample.flags |= ForceSample::kHasHere;
  }
  if ((state.flags & protocol::ToolState::kWantsAhead) != 0) {
    const Vec3 way =
        to_seconds(Time{state.lead_ns}) * (state.v_W - surface_v_W);  // on the organ as it stands
    sample.ahead_p_W = state.p_W + std::min(1.0, kFarthestAhead / way.norm()) * way;
    if (!sample.ahead_p_W.allFinite()) sample.ahead_p_W = state.p_W;
    const Simulation::Linearised there = simulation_.linearise(tool, sample.ahead_p_W, nullptr);
    sample.ahead_f_W = there.force;
    sample.ahead = on_the_wire(there);
    sample.flags |= ForceSample::kHasAhead;
  }
}

}  // namespace palpate::sim
