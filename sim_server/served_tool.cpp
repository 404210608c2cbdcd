#include "sim_server/served_tool.h"

namespace palpate::sim {
using protocol::ForceSample;

std::optional<ServedTool::Outcome> ServedTool::step(const ToolInput& input, bool fresh, double dt) noexcept {
  if (input.session != session_) {  // in another hand, or nobody's: it does not travel from one to the other
    simulation_.lift_tool();
    session_ = input.session;
    samples_ = 0;
  }
  if (session_ == 0) return {};
  const bool lost = (input.state.flags & protocol::ToolState::kDeviceLost) != 0;
  if (lost) simulation_.lift_tool();  // its pose is the last one known, or none: it touches nothing
  const ToolForce force = lost ? ToolForce{} : simulation_.step(input.state.p_W, dt);
  if (!fresh) return Outcome{force, {}};
  const std::uint32_t flags =
      (force.contacts > 0 ? ForceSample::kInContact : 0) | (force.flagged ? ForceSample::kFlagged : 0);
  return Outcome{force,
                 ForceSample{.tool = input.state.tool,
                             .number = ++samples_,
                             .tool_tick = input.state.tick,
                             .tool_t_ns = input.state.t_ns,
                             .p_W = input.state.p_W,
                             .f_W = force.force,
                             .torque_W = Vec3::Zero(),  // every normal passes through the centre of a sphere
                             .flags = flags}};
}

}  // namespace palpate::sim
