#pragma once
/// Inputs of a simulation in a test.
#include <array>
#include <vector>

#include "sim_server/simulation/simulation.h"

namespace palpate::test {

/// Tools at these poses, or lifted, that ask for their tangents.
inline std::vector<sim::ToolInput> inputs(std::span<const std::optional<ToolPose>> poses) {
  std::vector<sim::ToolInput> inputs;
  for (const std::optional<ToolPose>& pose : poses) inputs.push_back({.pose = pose});
  return inputs;
}

/// Lifts all tools, while no time passes.
inline void lift_tools(sim::Simulation& simulation) {
  simulation.step(std::vector<sim::ToolInput>(simulation.tools()), 0);
}

/// One step of tool 0 of `simulation` at `p_W` (m), asked and told whatever else `input` says, the others
/// lifted.
inline sim::ToolAnswer step(sim::Simulation& simulation, const Vec3& p_W, sim::ToolInput input, double dt) {
  std::vector<sim::ToolInput> all(simulation.tools());
  input.pose = ToolPose(p_W);
  all.front() = input;
  return simulation.step(all, dt).front();
}

}  // namespace palpate::test
