#include "sim_server/deformation/reduced.h"

#include <cmath>
#include <fmt/core.h>

#include "sim_server/deformation/linear_statics.h"

namespace palpate::sim {
namespace {

/// e^(-g T) cosh(r T) and e^(-g T) sinh(r T) / r with r^2 = g^2 - w^2 of either sign.
std::pair<double, double> decay(double w, double g, double period) {
  const double square = g * g - w * w, r = std::sqrt(std::abs(square));
  if (r * period < 1e-6) return {std::exp(-g * period), period * std::exp(-g * period)};
  if (square < 0)
    return {std::exp(-g * period) * std::cos(r * period), std::exp(-g * period) * std::sin(r * period) / r};
  const double slow = std::exp((r - g) * period), quick = std::exp(-(r + g) * period);
  return {0.5 * (slow + quick), 0.5 * (slow - quick) / r};
}

}  // namespace

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

Reduced::Step Reduced::step_of(double w, double damping, double period) {
  const double g = 0.5 * damping;
  const auto [even, odd] = decay(w, g, period);
  Step step{};
  step.q_of_q = even + g * odd;
  step.q_of_v = odd;
  step.v_of_q = -w * w * odd;
  step.v_of_v = even - g * odd;
  step.q_of_p = (1 - step.q_of_q) / (w * w);
  step.v_of_p = odd;
  return step;
}

Reduced::Reduced(const ModelInputs& inputs) : period_(step_period(inputs.scene)), compliance_(inputs) {
  const DeformationSettings& settings = inputs.scene.deformation;
  const auto& damping = settings.of<RayleighDamping>();
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  const LinearStatics statics(inputs);
  supports_ = statics.supports(Following::kSwinging);
  free_.assign(unloaded().begin(), unloaded().end());
  positions_ = free_;
  inputs.progress(name_of(Stage::kModes), 0);
  const VibrationModes modes = vibration_modes(statics.factor(), statics.masses(),
                                               settings.of<ReducedSettings>().modes, settings.where);
  const auto count = modes.frequencies.size();
  shapes_ = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(rest_.size()), count);
  for (std::size_t v = 0; v < rest_.size(); ++v) {
    const int first = statics.dofs.first[inputs.surface.vertices[v]];
    if (first >= 0)
      shapes_.middleRows<3>(3 * static_cast<Eigen::Index>(v)) = modes.shapes.middleRows<3>(first);
  }
  Eigen::VectorXd beyond_statics(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double w = modes.frequencies[k];
    steps_.push_back(step_of(w, damping.mass + damping.stiffness * w * w, period_));
    beyond_statics[k] = steps_.back().q_of_p - 1 / (w * w);
  }
  q_ = v_ = p_ = q_free_ = Eigen::VectorXd::Zero(count);
  moved_.setZero(shapes_.rows());
  loads_.reserve(kMaxTools * inputs.reachable.size());
  statics.fill(compliance_);
  compliance_.add(shapes_, beyond_statics);
  inputs.progress(name_of(Stage::kCompliance), 1);
}

FreeMotion Reduced::free_motion(double dt) noexcept {
  if (dt > 0) {
    for (Eigen::Index k = 0; k < q_.size(); ++k) {
      const Step& step = steps_[static_cast<std::size_t>(k)];
      const double q = step.q_of_q * q_[k] + step.q_of_v * v_[k] + step.q_of_p * p_[k];
      v_[k] = step.v_of_q * q_[k] + step.v_of_v * v_[k] + step.v_of_p * p_[k];
      q_[k] = q;
      q_free_[k] = step.q_of_q * q + step.q_of_v * v_[k];
    }
    moved_.noalias() = shapes_ * q_free_;
    if (supports_) supports_->advance(period_);
    for (std::size_t v = 0; v < rest_.size(); ++v)
      free_[v] = unloaded()[v] + moved_.segment<3>(3 * static_cast<Eigen::Index>(v));
    press(loads_);
  }
  return {free_, supports_ ? supports_->velocities() : std::span<const Vec3>(), positions_};
}

void Reduced::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_.fill(vertices, patch);
}

std::span<const Vec3> Reduced::apply(std::span<const NodalLoad> loads) noexcept {
  p_.setZero();
  for (const NodalLoad& load : loads)
    p_.noalias() +=
        shapes_.middleRows<3>(3 * static_cast<Eigen::Index>(load.vertex)).transpose() * load.force;
  loads_.assign(loads.begin(), loads.end());
  press(loads);
  return positions_;
}

void Reduced::press(std::span<const NodalLoad> loads) noexcept {
  std::copy(free_.begin(), free_.end(), positions_.begin());
  compliance_.move(loads, positions_);
}

std::vector<MemoryPart> Reduced::memory() const {
  std::vector<MemoryPart> parts{{"compliance", compliance_.bytes(), compliance_.detail()},
                                {"modes",
                                 static_cast<std::size_t>(shapes_.size() + 5 * q_.size()) * sizeof(double) +
                                     steps_.size() * sizeof(Step),
                                 fmt::format("{} of vibration", q_.size())},
                                {"positions", 3 * rest_.size() * sizeof(Vec3) + compliance_.index_bytes()}};
  if (supports_) parts.push_back({"moving supports", supports_->bytes()});
  return parts;
}

}  // namespace palpate::sim
