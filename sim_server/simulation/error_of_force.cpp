#include "sim_server/simulation/error_of_force.h"

#include "sim_server/models/deformation_models.h"
#include "sim_server/simulation/element_trial.h"

namespace palpate::sim {
namespace {

/// Friction remembers the path, and tissue in motion where it was: their force depends on the steps taken.
bool steps_matter(const Scene& scene, const ToolSettings& tool) {
  return model_of(scene.deformation).moves || tool.shape.friction > 0;
}

/// Errors without those that the method does not make.
DiscretisationErrors those_by_method(DiscretisationErrors errors, bool deforms, bool steps_matter) {
  if (!deforms) errors.mesh = {.source = ErrorSource::kNone};
  if (!steps_matter) errors.time_step = {.source = ErrorSource::kNone};
  return errors;
}

/// The surface vertex in the middle of what the first tool can touch, where a trial presses (`find_press`).
int middle_of_reach(const Simulation& simulation) {
  std::vector<int> vertices;
  for (const Triangle& t : simulation.touchable(0)) vertices.insert(vertices.end(), t.begin(), t.end());
  Vec3 middle = Vec3::Zero();
  const auto rest = [&](int v) -> const Vec3& { return simulation.rest()[static_cast<std::size_t>(v)]; };
  for (const int v : vertices) middle += rest(v) / static_cast<double>(vertices.size());
  return *std::ranges::min_element(vertices, {}, [&](int v) { return (rest(v) - middle).squaredNorm(); });
}

/// Returns the error by elements of which the table says nothing, by a trial that pressed on such; nothing
/// where there are none, or they were not tried.
std::optional<double> tried_error(const Scene& scene, const Simulation& simulation,
                                  const std::optional<ThinTissue>& thin) {
  if (!thin || simulation.touchable(0).empty()) return {};
  const bool locks = scene.material->locks();
  if (!locks && !thin->is_thin_at(middle_of_reach(simulation))) return {};
  const auto trial = try_elements(scene, simulation.mesh());
  if (!trial || !(locks || thin->bears(trial->loads))) return {};
  return trial->percent;
}

}  // namespace

ErrorOfForce::ErrorOfForce(const Scene& scene, const Simulation& simulation,
                           const std::optional<StudiedErrors>& studied) {
  const bool deforms = scene.material && model_of(scene.deformation).deforms();
  if (deforms && scene.material->element == ElementKind::kLinear) {
    thin_.emplace(simulation.mesh(), simulation.surface(), fixed_vertices(scene, simulation.mesh()));
  }
  const std::optional<double> tried = tried_error(scene, simulation, thin_);
  for (const ToolSettings& tool : scene.tools) {
    const DiscretisationErrors errors = those_by_method({}, deforms, steps_matter(scene, tool));
    std::optional<ElementKind> element;
    if (deforms && !tool.grasps() && !scene.material->locks())
      element = scene.material->element;  // the estimate is of tips that press
    const double radius = tool.shape.radius;
    const bool is_tried = tried && !tool.grasps() && radius == scene.tools.front().shape.radius;
    tools_.push_back({errors, element, is_tried ? tried : std::nullopt,
                      scene.cutting
                          ? MeshResolution(simulation.surface(), simulation.rest(), radius, simulation.mesh())
                          : MeshResolution(simulation.surface(), simulation.rest(), radius)});
  }
  const ToolSettings& first = scene.tools.front();
  if (!studied || first.grasps()) return;  // a study presses
  const Vec3 margin = Vec3::Constant(first.shape.radius);
  studied_ = {.errors = those_by_method(studied->errors, deforms, steps_matter(scene, first)),
              .near = {studied->pressed.min - margin, studied->pressed.max + margin},
              .rest = {simulation.rest().begin(), simulation.rest().end()},
              .most_newton = studied->most_newton};
}

/// True if a study has pressed there, and about as hard.
bool ErrorOfForce::was_studied(std::size_t tool, std::span<const VertexLoad> loads) const noexcept {
  constexpr double kAsHard = 1.5;  // 1.3 times as deep, as the force of a ball goes with its depth ^ 1.5
  if (!studied_ || tool != 0) return false;
  // Between vertices that are far apart it bears on these, however near it is: their middle is where it is.
  Vec3 force = Vec3::Zero(), middle = Vec3::Zero();
  double all = 0;
  for (const VertexLoad& load : loads) {
    const auto vertex = static_cast<std::size_t>(load.vertex);
    if (vertex >= studied_->rest.size()) continue;  // one that a cut has made
    const double size = load.force.norm();
    force += load.force;
    all += size;
    if (all > 0) middle += size / all * (studied_->rest[vertex] - middle);
  }
  return all > 0 && studied_->near.contains(middle) && force.norm() <= kAsHard * studied_->most_newton;
}

std::optional<double> ErrorOfForce::finest(std::size_t tool, std::span<const Triangle> touchable) const {
  return tools_[tool].element ? tools_[tool].mesh.finest(touchable) : std::nullopt;
}

DiscretisationErrors ErrorOfForce::of_step(std::size_t tool,
                                           std::span<const VertexLoad> loads) const noexcept {
  if (was_studied(tool, loads)) return studied_->errors;
  if (thin_ && thin_->bears(loads)) return beyond_table(tool);
  return of(tool, tools_[tool].mesh.of(loads));
}

DiscretisationErrors ErrorOfForce::beyond_table(std::size_t tool) const noexcept {
  DiscretisationErrors errors = tools_[tool].known;
  if (tools_[tool].tried) errors.mesh = {ErrorSource::kEstimated, static_cast<float>(*tools_[tool].tried)};
  return errors;
}

DiscretisationErrors ErrorOfForce::of(std::size_t tool,
                                      std::optional<double> elements_per_radius) const noexcept {
  const OfTool& of = tools_[tool];
  if (!of.element) return beyond_table(tool);
  DiscretisationErrors errors = of.known;
  if (!elements_per_radius) return errors;
  if (const auto percent = estimated_mesh_error(*of.element, *elements_per_radius))
    errors.mesh = {ErrorSource::kEstimated, static_cast<float>(*percent)};
  return errors;
}

}  // namespace palpate::sim
