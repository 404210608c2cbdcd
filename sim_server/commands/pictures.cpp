#include "sim_server/commands/pictures.h"

#include <algorithm>

namespace palpate::sim {
namespace {

OrganShape shape_of(const Scene& scene, const Simulation& simulation) {
  const Surface& surface = simulation.surface();
  OrganShape organ{simulation.rest(), surface.triangles, std::vector<std::uint8_t>(surface.vertices.size())};
  const std::vector<int> fixed = fixed_vertices(scene, simulation.mesh());
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    if (std::ranges::binary_search(fixed, surface.vertices[v])) organ.flags[v] |= OrganShape::kFixed;
  }
  for (std::size_t i = 0; i < simulation.tools(); ++i) {
    for (const Triangle& triangle : simulation.touchable(i)) {
      for (const int v : triangle) organ.flags[static_cast<std::size_t>(v)] |= OrganShape::kInReach;
    }
  }
  return organ;
}

void show_loads(std::span<const NodalLoad> loads, SeenTool& seen) noexcept {
  seen.load_count = std::min(loads.size(), SeenTool::kMostLoads);
  for (std::size_t k = 0; k < seen.load_count; ++k) {
    seen.loads[k].vertex = static_cast<std::uint32_t>(loads[k].vertex);
    for (std::size_t i = 0; i < 3; ++i)
      seen.loads[k].force[i] = static_cast<float>(loads[k].force[static_cast<Eigen::Index>(i)]);
  }
}

}  // namespace

SceneFacts facts_of(const Scene& scene, const Simulation& simulation) {
  SceneFacts facts{.title = scene.title,
                   .file = scene.source,
                   .model = scene.deformation.model,
                   .rate_hz = scene.rate_hz,
                   .tools = {},
                   .organ = shape_of(scene, simulation)};
  for (const ToolSettings& tool : scene.tools) facts.tools.push_back(tool.shape);
  return facts;
}

void show_tool(const SessionInput& input, const ServedTools::Outcome* outcome, double t,
               SeenTool& seen) noexcept {
  const bool lost = (input.state.flags & protocol::ToolState::kDeviceLost) != 0;
  seen.held = input.session != 0 && !lost;
  if (seen.held) seen.pose = pose_of(input.state);
  if (outcome == nullptr) return;
  const ToolForce& force = outcome->force;
  seen.contact = force.contacts > 0;
  seen.flagged = force.flagged;
  seen.f_W = force.force;
  if (outcome->answer)
    seen.sample = {outcome->answer->number, t, static_cast<float>(force.force.norm()),
                   outcome->answer->flags};
}

void show_organ(const Simulation& simulation, Picture& picture) noexcept {
  std::size_t k = 0;
  for (const Vec3& p : simulation.positions()) {
    for (int i = 0; i < 3; ++i) picture.positions[k++] = static_cast<float>(p[i]);
  }
  for (std::size_t i = 0; i < simulation.tools(); ++i) show_loads(simulation.loads(i), picture.tools[i]);
}

}  // namespace palpate::sim
