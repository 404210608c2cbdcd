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

}  // namespace

ErrorOfForce::ErrorOfForce(const Scene& scene, const Simulation& simulation,
                           const std::optional<StudiedErrors>& studied)
    : rest_(simulation.rest()) {
  const bool deforms = scene.material && model_of(scene.deformation).deforms();
  if (deforms) add_trials(scene, simulation);
  for (const ToolSettings& tool : scene.tools) {
    const DiscretisationErrors errors = those_by_method({}, deforms, steps_matter(scene, tool));
    std::optional<ElementKind> element;
    if (deforms && !tool.grasps() && !scene.material->locks())
      element = scene.material->element;  // the table is of tips that press
    const double radius = tool.shape.radius;
    const bool tried = !tool.grasps() && radius == scene.tools.front().shape.radius;
    tools_.push_back({errors, element, tried,
                      scene.cutting
                          ? MeshResolution(simulation.surface(), simulation.rest(), radius, simulation.mesh())
                          : MeshResolution(simulation.surface(), simulation.rest(), radius)});
  }
  const ToolSettings& first = scene.tools.front();
  if (!studied || first.grasps()) return;  // a study presses
  const Vec3 margin = Vec3::Constant(first.shape.radius);
  studied_ = {.errors = those_by_method(studied->errors, deforms, steps_matter(scene, first)),
              .near = {studied->pressed.min - margin, studied->pressed.max + margin},
              .most_newton = studied->most_newton};
}

void ErrorOfForce::add_trials(const Scene& scene, const Simulation& simulation) {
  if (scene.material->element == ElementKind::kLinear)
    thin_.emplace(simulation.mesh(), simulation.surface(), fixed_vertices(scene, simulation.mesh()));
  ElementTrials trials = try_elements(scene, simulation.mesh());
  why_no_press_ = std::move(trials.why_none);
  for (const ElementTrial& trial : trials.presses) {
    if (const auto load = sum_of_loads(trial.loads))
      trials_.push_back({*load, thin_->bears(trial.loads), trial.percent});
  }
}

/// The middle is weighted: between vertices that are far apart a tool bears on these, however near it is.
/// Nothing where it loads nothing that was there at set-up.
std::optional<ErrorOfForce::Load> ErrorOfForce::sum_of_loads(
    std::span<const VertexLoad> loads) const noexcept {
  Load sum{Vec3::Zero(), Vec3::Zero()};
  double all = 0;
  for (const VertexLoad& load : loads) {
    const auto vertex = static_cast<std::size_t>(load.vertex);
    if (vertex >= rest_.size()) continue;  // one that a cut has made
    const double size = load.force.norm();
    sum.force += load.force;
    all += size;
    if (all > 0) sum.middle += size / all * (rest_[vertex] - sum.middle);
  }
  return all > 0 ? std::optional(sum) : std::nullopt;
}

/// True if a study has pressed there, and about as hard.
bool ErrorOfForce::was_studied(std::size_t tool, const Load& load) const noexcept {
  constexpr double kAsHard = 1.5;  // 1.3 times as deep, as the force of a ball goes with its depth ^ 1.5
  return studied_ && tool == 0 && studied_->near.contains(load.middle) &&
         load.force.norm() <= kAsHard * studied_->most_newton;
}

std::optional<double> ErrorOfForce::finest(std::size_t tool, std::span<const Triangle> touchable) const {
  return tools_[tool].element ? tools_[tool].mesh.finest(touchable) : std::nullopt;
}

DiscretisationErrors ErrorOfForce::of_step(std::size_t tool,
                                           std::span<const VertexLoad> loads) const noexcept {
  const OfTool& of = tools_[tool];
  const std::optional<Load> load = sum_of_loads(loads);
  if (load && was_studied(tool, *load)) return studied_->errors;
  const bool thin = thin_ && thin_->bears(loads);
  const std::optional<double> tried = of.tried && load ? by_trial(*load, thin) : std::nullopt;
  const std::optional<double> fine = by_table(tool, loads);
  DiscretisationErrors errors = of.known;
  if (tried || (fine && !thin)) {
    errors.mesh = {ErrorSource::kEstimated,
                   static_cast<float>(std::max(tried.value_or(0), fine.value_or(0)))};
  }
  return errors;
}

std::optional<double> ErrorOfForce::by_table(std::size_t tool,
                                             std::span<const VertexLoad> loads) const noexcept {
  const std::optional<double> elements_per_radius = tools_[tool].mesh.of(loads);
  if (!tools_[tool].element || !elements_per_radius) return {};
  return estimated_mesh_error(*tools_[tool].element, *elements_per_radius);
}

/// By the nearest press, on tissue that bends or that does not: where a strip is thin, pushed aside it is
/// thick.
std::optional<double> ErrorOfForce::by_trial(const Load& load, bool thin) const noexcept {
  constexpr double kAlong = 0.5;  // cosine
  const auto is_such = [&](const Trial& trial) {
    const Vec3& force = trial.load.force;
    return trial.thin == thin && std::abs(force.dot(load.force)) >= kAlong * force.norm() * load.force.norm();
  };
  const auto distance = [&](const Trial& trial) { return (trial.load.middle - load.middle).norm(); };
  const Trial* nearest = nullptr;
  for (const Trial& trial : trials_) {
    if (is_such(trial) && (nearest == nullptr || distance(trial) < distance(*nearest))) nearest = &trial;
  }
  return nearest != nullptr ? std::optional(nearest->percent) : std::nullopt;
}

std::size_t ErrorOfForce::bytes() const noexcept {
  std::size_t sum =
      rest_.size() * sizeof(Vec3) + trials_.size() * sizeof(Trial) + (thin_ ? thin_->bytes() : 0);
  for (const OfTool& tool : tools_) sum += sizeof(OfTool) + tool.mesh.bytes();
  return sum;
}

}  // namespace palpate::sim
