#include "sim_server/simulation/error_of_force.h"

#include "sim_server/models/deformation_models.h"

namespace palpate::sim {
namespace {

/// Friction remembers the path, and tissue in motion where it was: their force depends on the steps taken.
bool steps_matter(const Scene& scene, const ToolSettings& tool) {
  return model_of(scene.deformation).moves || tool.shape.friction > 0;
}

}  // namespace

ErrorOfForce::ErrorOfForce(const Scene& scene, const Simulation& simulation,
                           const std::optional<DiscretisationErrors>& studied) {
  const bool deforms = scene.material && model_of(scene.deformation).deforms();
  if (deforms && scene.material->element == ElementKind::kLinear) {
    thin_.emplace(simulation.mesh(), simulation.surface(), fixed_vertices(scene, simulation.mesh()));
  }
  for (const ToolSettings& tool : scene.tools) {
    DiscretisationErrors errors;
    if (studied && tools_.empty() && !tool.grasps()) errors = *studied;  // it pressed with the first tool
    if (!deforms) errors.mesh.source = ErrorSource::kNone;
    if (!steps_matter(scene, tool)) errors.time_step = {.source = ErrorSource::kNone};
    std::optional<ElementKind> element;
    if (deforms && !tool.grasps() && !scene.material->locks())
      element = scene.material->element;  // the estimate is of tips that press
    const double radius = tool.shape.radius;
    tools_.push_back({errors, element,
                      scene.cutting
                          ? MeshResolution(simulation.surface(), simulation.rest(), radius, simulation.mesh())
                          : MeshResolution(simulation.surface(), simulation.rest(), radius)});
  }
}

std::optional<double> ErrorOfForce::finest(std::size_t tool, std::span<const Triangle> touchable) const {
  return tools_[tool].element ? tools_[tool].mesh.finest(touchable) : std::nullopt;
}

DiscretisationErrors ErrorOfForce::of_step(std::size_t tool,
                                           std::span<const VertexLoad> loads) const noexcept {
  if (thin_ && thin_->bears(loads)) return tools_[tool].known;
  return of(tool, tools_[tool].mesh.of(loads));
}

DiscretisationErrors ErrorOfForce::of(std::size_t tool,
                                      std::optional<double> elements_per_radius) const noexcept {
  const OfTool& of = tools_[tool];
  DiscretisationErrors errors = of.known;
  if (errors.mesh.known() || !of.element || !elements_per_radius) return errors;
  if (const auto percent = estimated_mesh_error(*of.element, *elements_per_radius))
    errors.mesh = {ErrorSource::kEstimated, static_cast<float>(*percent)};
  return errors;
}

}  // namespace palpate::sim
