#include "sim_server/models/reduced.h"

#include <cmath>
#include <fmt/core.h>

#include "sim_server/statics/linear_statics.h"

namespace palpate::sim {
ReducedSettings ReducedSettings::read(const Config& config) {
  ReducedSettings settings;
  settings.modes = static_cast<int>(config.integer("modes", {1, 1000, "modes"}, settings.modes));
  return settings;
}

std::string ReducedSettings::to_text() const {
  return fmt::format("modes = {}\n", modes);
}

double Reduced::estimated_bytes(const Scene& scene, const MeshCounts& counts) {
  const ElementKind element = scene.material->element;
  // Vectors that modes are found among, and what is kept of them.
  const double vectors = 3.0 * scene.deformation.of<ReducedSettings>().modes + 20;
  return body_bytes(counts, element, 1) + 3 * nodes_of(counts, element) * sizeof(double) * vectors;
}

/// Returns how many instants make steps that are short for the fastest mode (`w`, rad/s) and for the error of
/// the force; 1 where that exceeds 100. With a number in between contact chatters: each force answers what
/// the last one left swinging.
int Reduced::usual_instants(double period, double w) {
  constexpr double kStepTime = 1.25e-3, kShort = 1, kMost = 100,
                   kRounding = 1e-9;  // s; of 1 / w; both numbers
  const double wanted = std::ceil(period / std::min(kStepTime, kShort / w) - kRounding);
  return wanted <= kMost ? static_cast<int>(wanted) : 1;
}

Reduced::Reduced(const ModelInputs& inputs) : period_(step_period(inputs.scene)), compliance_(inputs) {
  const DeformationSettings& settings = inputs.scene.deformation;
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  const LinearStatics statics(inputs);
  supports_ = statics.supports(Following::kSwinging);
  free_.assign(unloaded().begin(), unloaded().end());
  positions_ = free_;
  const VibrationModes found = statics.modes(settings.of<ReducedSettings>().modes, settings.where);
  std::vector<int> first;
  for (const int vertex : inputs.surface.vertices) first.push_back(statics.dofs.first[vertex]);
  modes_note_ = found.note;
  modes_.emplace(found, first, settings.of<RayleighDamping>());
  const auto count = modes_->frequencies.size();
  instants_ = instants_of(settings, usual_instants(period_, modes_->frequencies[count - 1]));
  period_ /= instants_;
  Eigen::VectorXd beyond_statics(count);
  beyond_residual_ = modes_->published_at_rest();
  for (Eigen::Index k = 0; k < count; ++k) {
    const double w = modes_->frequencies[k];
    steps_.push_back(ModeStep::over(period_, w, modes_->damping[k]));
    beyond_statics[k] = steps_.back().q_of_p - 1 / (w * w);
  }
  beyond_residual_ += beyond_statics;
  q_ = v_ = p_ = q_free_ = Eigen::VectorXd::Zero(count);
  moved_.setZero(modes_->shapes.rows());
  loads_.reserve(kMaxTools * inputs.reachable.size());
  statics.fill(compliance_);
  compliance_.add(modes_->shapes, beyond_statics);
  inputs.progress(name_of(Stage::kCompliance), 1);
}

FreeMotion Reduced::free_motion(double dt) noexcept {
  if (dt > 0) {
    for (Eigen::Index k = 0; k < q_.size(); ++k) {
      const ModeStep& step = steps_[static_cast<std::size_t>(k)];
      step.advance(q_[k], v_[k], p_[k]);
      q_free_[k] = step.q_of_q * q_[k] + step.q_of_v * v_[k];
    }
    moved_.noalias() = modes_->shapes * q_free_;
    if (supports_) supports_->advance(period_);
    for (std::size_t v = 0; v < rest_.size(); ++v)
      free_[v] = unloaded()[v] + moved_.segment<3>(3 * static_cast<Eigen::Index>(v));
    apply_loads(loads_);
  }
  return free_motion_now();
}

FreeMotion Reduced::free_motion_now() const {
  return {.positions = free_,
          .velocities = supports_ ? supports_->velocities() : std::span<const Vec3>(),
          .loaded = positions_,
          .carried = supports_ ? supports_->positions() : std::span<const Vec3>()};
}

ModelTraits Reduced::traits() noexcept {
  return {.instants = instants_,
          .constant_compliance = true,
          .columns = &compliance_,
          .client = this,
          .later = this,
          .state = this};
}

std::any Reduced::save() {
  State state{q_, v_, p_, q_free_, loads_, free_, positions_, {}};
  if (supports_) state.supports = supports_->state();
  return state;
}

FreeMotion Reduced::restore(const std::any& saved) {
  const auto& state = std::any_cast<const State&>(saved);
  q_ = state.q;
  v_ = state.v;
  p_ = state.p;
  q_free_ = state.q_free;
  loads_.assign(state.loads.begin(), state.loads.end());
  free_ = state.free;
  positions_ = state.positions;
  if (supports_) supports_->set_state(*state.supports);
  return free_motion_now();
}

void Reduced::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_.fill(vertices, patch);
}

Mat3 Reduced::later_compliance(std::span<const VertexLoad> loads, double seconds) const noexcept {
  return modes_->yield_(loads, seconds, period_, modes_->frequencies.size());
}

void Reduced::read_modes(ModalMotion& state) noexcept {
  state.q = q_.head(state.q.size());
  state.v = v_.head(state.q.size());
  for (Eigen::Index k = 0; k < state.q.size(); ++k)
    steps_[static_cast<std::size_t>(k)].advance(state.q[k], state.v[k], p_[k]);
}

void Reduced::residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_.fill(vertices, patch);
  modes_->take_out(vertices, beyond_residual_, patch);
}

std::span<const Vec3> Reduced::apply(std::span<const VertexLoad> loads) noexcept {
  p_.setZero();
  for (const VertexLoad& load : loads)
    p_.noalias() +=
        modes_->shapes.middleRows<3>(3 * static_cast<Eigen::Index>(load.vertex)).transpose() * load.force;
  loads_.assign(loads.begin(), loads.end());
  apply_loads(loads);
  return positions_;
}

void Reduced::apply_loads(std::span<const VertexLoad> loads) noexcept {
  std::ranges::copy(free_, positions_.begin());
  compliance_.move(loads, positions_);
}

std::vector<MemoryPart> Reduced::memory() const {
  std::vector<MemoryPart> parts{
      {"compliance", compliance_.bytes(), compliance_.detail()},
      {"modes",
       static_cast<std::size_t>(modes_->shapes.size() + 5 * q_.size()) * sizeof(double) +
           steps_.size() * sizeof(ModeStep),
       fmt::format("{} of vibration{}{}", q_.size(), modes_note_.empty() ? "" : ", ", modes_note_)},
      {"positions", 3 * rest_.size() * sizeof(Vec3) + compliance_.index_bytes()}};
  if (supports_) parts.push_back({"moving supports", supports_->bytes()});
  return parts;
}

}  // namespace palpate::sim
