#include "sim_server/models/rigid.h"

#include <fmt/core.h>

namespace palpate::sim {

RigidSettings RigidSettings::read(const Config& config) {
  RigidSettings settings;
  settings.stiffness = config.number("stiffness", {1e-3, 1e6, "N/m"}, settings.stiffness);
  return settings;
}

std::string RigidSettings::to_text() const {
  return fmt::format("stiffness = {:g}\n", stiffness);
}

Rigid::Rigid(const ModelInputs& inputs) : stiffness_(inputs.scene.deformation.of<RigidSettings>().stiffness) {
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
}

FreeMotion Rigid::free_motion(double) noexcept {
  return {rest_};
}

void Rigid::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  const auto size = 3 * static_cast<Eigen::Index>(vertices.size());
  patch.compliance.topLeftCorner(size, size).setZero();
  patch.tool_compliance = 1 / stiffness_;
}

std::span<const Vec3> Rigid::apply(std::span<const VertexLoad>) noexcept {
  return rest_;
}

std::vector<MemoryPart> Rigid::memory() const {
  return {{"rest_positions", rest_.size() * sizeof(Vec3)}};
}

}  // namespace palpate::sim
