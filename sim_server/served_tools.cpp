#include "sim_server/served_tools.h"

#include <algorithm>
#include <cassert>

namespace palpate::sim {
using protocol::ForceSample;

ServedTools::ServedTools(Simulation& simulation)
    : simulation_(simulation),
      holders_(simulation.tools()),
      places_(simulation.tools()),
      outcomes_(simulation.tools()) {}

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
    places_[i].reset();
    if (inputs[i].session != 0 && !lost) places_[i] = inputs[i].state.p_W;
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
  return ForceSample{.tool = static_cast<std::uint8_t>(tool),
                     .number = ++holders_[tool].samples,
                     .tool_tick = input.state.tick,
                     .tool_t_ns = input.state.t_ns,
                     .p_W = input.state.p_W,
                     .f_W = force.force,
                     .torque_W = Vec3::Zero(),  // every normal passes through the centre of a sphere
                     .flags = flags};
}

}  // namespace palpate::sim
