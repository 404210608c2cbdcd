#include "sim_server/models/tensor_mass.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "common/error.h"
#include "sim_server/explicit/cuttable_motion.h"
#include "sim_server/scene/held_motion.h"
#include "sim_server/statics/linear_statics.h"

namespace palpate::sim {
namespace {

constexpr int kFew = 8;                 // sub-steps: longer periods let waves carry off what is left
constexpr double kWorkPerReport = 1e8;  // edges x sub-steps between two reports: some seconds
constexpr double kSafety = 0.95;        // of the longest stable sub-step; the frequency is known from below

ElasticTensors assemble(const ModelInputs& inputs) {
  const Scene& scene = inputs.scene;
  step_period(scene);  // before any work
  require_held_tissue(inputs);
  require_no_loose_part(inputs);
  inputs.progress(name_of(Stage::kTensors), 0);
  return {inputs.mesh, *scene.material, inputs.fixed};
}

/// Returns how many contact instants a step of `steps` sub-steps has: one for each, up to 500; beyond that
/// one for every few, as few as `calm_loaded` calms. A force held over T lags by T / 2: at 500 instants in
/// 1/30 s by 0.1 degrees of 8 Hz. An instant costs some 25 us (a tip that presses on a block of 8 x 4 x 8
/// cells), so that 500 fit into a live step.
int usual_instants(double steps) {
  constexpr double kMost = 500;
  return static_cast<int>(std::ceil(steps / std::ceil(steps / kMost)));
}

const RayleighDamping& damping_of(const Scene& scene) {
  return scene.deformation.of<RayleighDamping>();
}

}  // namespace

TensorMass::TensorMass(const ModelInputs& inputs)
    : compliance_(inputs),
      tensors_(assemble(inputs)),
      motion_(tensors_, damping_of(inputs.scene)),
      start_(motion_.state),
      force_(start_.f),
      mesh_rest_(inputs.mesh.vertices),
      nodes_(mesh_rest_) {
  const auto* const published = inputs.scene.deformation.find<ClientModes>();
  const bool publishes = published != nullptr && published->modes > 0;
  if (publishes || supports_move(inputs.scene)) {
    const LinearStatics statics(inputs);
    supports_ = statics.supports(Following::kSwinging);
    if (publishes) published_.emplace(inputs, statics, tensors_.places(), tensors_.masses());
  }
  for (const int vertex : inputs.surface.vertices) {
    rest_.push_back(inputs.mesh.vertices[vertex]);
    const int place = tensors_.places()[vertex];
    first_.push_back(place < 0 ? -1 : 3 * place);
  }
  free_ = rest_;
  update_free();
  positions_ = free_;
  loads_.reserve(kMaxTools * inputs.reachable.size());
  choose_sub_step(inputs);
  precompute(inputs);
}

std::unique_ptr<DeformationModel> TensorMass::make(const ModelInputs& inputs) {
  if (inputs.scene.cutting) return std::make_unique<CuttableMotion>(inputs);
  const auto* const added = inputs.scene.deformation.find<AddedMass>();
  if (added != nullptr && added->fraction)
    fail("{}: `added_mass`: only tissue that can be cut gets more mass; remove it, or add [cutting]",
         inputs.scene.deformation.where);
  return std::make_unique<TensorMass>(inputs);
}

double TensorMass::estimated_bytes(const Scene& scene, const MeshCounts& counts) {
  const bool factors = supports_move(scene) || scene.deformation.find<ClientModes>() != nullptr;
  if (scene.cutting)
    return tensors_bytes(counts) + published_bodies(scene) * body_bytes(counts, scene.material->element, 1);
  return tensors_bytes(counts) + (factors ? body_bytes(counts, scene.material->element, 1) : 0);
}

void TensorMass::choose_sub_step(const ModelInputs& inputs) {
  inputs.progress(name_of(Stage::kFrequency), 0);
  const double longest = kSafety * longest_sub_step(highest_frequency(tensors_), damping_of(inputs.scene));
  const double period = step_period(inputs.scene);
  instants_ = instants_of(inputs.scene.deformation, usual_instants(count_sub_steps(inputs.scene, longest)));
  sub_steps_ = static_cast<int>(std::ceil(period / instants_ / longest));
  sub_step_ = period / instants_ / sub_steps_;
}

void TensorMass::precompute(const ModelInputs& inputs) {
  constexpr Eigen::Index kWide = ElasticTensors::kWide;
  const auto number = [&](Eigen::Index row, Eigen::Index column) {
    return (first_[compliance_.vertices()[row / 3]] + row % 3) * kWide + column;
  };
  const auto respond = [&](Eigen::Index from, Eigen::Ref<Eigen::MatrixXd> columns) {
    ExplicitMotion motion(tensors_, damping_of(inputs.scene), kWide);
    std::vector<double> force = motion.state.f;
    for (Eigen::Index c = 0; c < columns.cols(); ++c) force[number(from + c, c)] = 1;
    run_period(motion, force);
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      for (Eigen::Index r = 0; r < columns.rows(); ++r) columns(r, c) = motion.state.u[number(r, c)];
    }
  };
  // A call of a second on one core where edges are many and sub-steps short; then each two are reported.
  const double work = static_cast<double>(sub_steps_) * static_cast<double>(tensors_.edges());
  const auto calls = static_cast<std::size_t>(std::clamp(kWorkPerReport / work, 2.0, 16.0));
  compliance_.compute(kWide, respond, inputs.progress, calls);
  inputs.progress(name_of(Stage::kCompliance), 1);
}

FreeMotion TensorMass::free_motion(double dt) noexcept {
  if (dt > 0) {
    run_on();
    if (supports_) supports_->advance(sub_steps_ * sub_step_);
    update_free();
    apply_loads(loads_);
  }
  return free_motion_now();
}

FreeMotion TensorMass::free_motion_now() const {
  return {.positions = free_,
          .velocities = supports_ ? supports_->velocities() : std::span<const Vec3>(),
          .loaded = positions_,
          .carried = supports_ ? supports_->positions() : std::span<const Vec3>()};
}

ModelTraits TensorMass::traits() noexcept {
  return {.instants = instants_,
          .constant_compliance = true,
          .leading_force = sub_steps_ == 1,
          .columns = &compliance_,
          .client = published_ ? this : nullptr,
          .later = this,
          .interior = supports_ ? nullptr : this,  // the motion of the supports inside is not stored
          .state = this};
}

std::any TensorMass::save() {
  State state{motion_.save(), start_, loads_, free_, positions_, {}};
  if (supports_) state.supports = supports_->state();
  return state;
}

FreeMotion TensorMass::restore(const std::any& saved) {
  const auto& state = std::any_cast<const State&>(saved);
  motion_.restore(state.motion);
  start_ = state.begin;
  loads_.assign(state.loads.begin(), state.loads.end());
  free_ = state.free;
  positions_ = state.positions;
  if (supports_) supports_->set_state(*state.supports);
  return free_motion_now();
}

/// One sub-step alone takes these forces for all of it, not their mean with those before: else forces that
/// are to lead somewhere at its end would have to swing about that mean.
void TensorMass::run_period(ExplicitMotion& motion, const std::vector<double>& force) const noexcept {
  if (sub_steps_ == 1) motion.state.f = force;
  motion.run(sub_steps_, sub_step_, force);
}

/// Updates where the body goes free of loads: by itself, and by its supports.
void TensorMass::update_free() noexcept {
  const std::span<const Vec3> from = supports_ ? supports_->positions() : rest_;
  std::ranges::copy(from, free_.begin());
  for (std::size_t v = 0; v < rest_.size(); ++v) {
    if (first_[v] >= 0) free_[v] += Eigen::Map<const Vec3>(motion_.state.u.data() + first_[v]);
  }
}

/// Calls `act` with each load that moves something: its first number, and its force.
template <class Act>
void TensorMass::for_loads(const Act& act) const {
  for (const VertexLoad& load : loads_) {
    if (compliance_.yields(load.vertex)) act(first_[load.vertex], load.force);
  }
}

/// The next period, free of loads, from where the last one led with its own. Over one sub-step a load moves
/// nothing but what it is on, so that nothing need be run again.
void TensorMass::run_on() noexcept {
  if (sub_steps_ == 1) {
    for_loads([&](int first, const Vec3& force) { motion_.add_to_last(first / 3, sub_step_, force); });
    return motion_.run_free(start_, sub_step_);
  }
  if (!loads_.empty()) {
    motion_.state = start_;
    for_loads([&](int first, const Vec3& force) { Eigen::Map<Vec3>(force_.data() + first) += force; });
    run_period(motion_, force_);
    std::ranges::fill(force_, 0);
    if (sub_steps_ <= kFew) calm_loaded();
  }
  start_ = motion_.state;
  run_period(motion_, force_);
}

void TensorMass::calm_loaded() noexcept {
  for_loads([&](int first, const Vec3& force) {
    const double newton = force.norm();
    if (!(newton > 0)) return;
    const auto at = [first](std::vector<double>& numbers) {
      return Eigen::Map<Vec3>(numbers.data() + first);
    };
    const Vec3 along = force / newton;
    const double mean = (at(motion_.state.u) - at(start_.u)).dot(along) / (sub_steps_ * sub_step_),
                 now = at(motion_.state.v).dot(along);
    if (std::abs(mean) < std::abs(now)) at(motion_.state.v) += (mean - now) * along;
  });
}

void TensorMass::apply_loads(std::span<const VertexLoad> loads) noexcept {
  std::ranges::copy(free_, positions_.begin());
  compliance_.move(loads, positions_);
}

void TensorMass::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_.fill(vertices, patch);
}

std::span<const Vec3> TensorMass::apply(std::span<const VertexLoad> loads) noexcept {
  loads_.assign(loads.begin(), loads.end());
  apply_loads(loads);
  return positions_;
}

Mat3 TensorMass::later_compliance(std::span<const VertexLoad> loads, double seconds) const noexcept {
  if (!published_) return Mat3::Zero();
  return published_->compliance(loads, seconds) - compliance_.of_loads(loads);
}

void TensorMass::read_modes(ModalMotion& state) noexcept {
  published_->begin(start_.u, start_.v, start_.f, 0.5 * sub_step_);
  const double time = sub_steps_ == 1 ? 0 : sub_steps_ * sub_step_;  // as the force that is rendered
  published_->advance(time, loads_, state.q, state.v);
}

void TensorMass::residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  published_->residual_compliance(vertices, patch);
}

std::span<const Vec3> TensorMass::nodes() const noexcept {
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    const int place = tensors_.places()[node];
    if (place >= 0) nodes_[node] = mesh_rest_[node] + Eigen::Map<const Vec3>(start_.u.data() + 3 * place);
  }
  return nodes_;
}

std::vector<MemoryPart> TensorMass::memory() const {
  std::vector<MemoryPart> parts{
      {"tensors", tensors_.bytes(),
       fmt::format("{} vertices, {} edges; {} sub-steps of {:.3g} ms", tensors_.vertices(), tensors_.edges(),
                   instants_ * sub_steps_, 1e3 * sub_step_)},
      {"compliance", compliance_.bytes(), compliance_.detail()},
      {"motion", motion_.bytes() + 4 * force_.size() * sizeof(double)},
      {"positions", (rest_.size() + free_.size() + positions_.size() + 2 * nodes_.size()) * sizeof(Vec3) +
                        loads_.capacity() * sizeof(VertexLoad) + first_.size() * sizeof(int) +
                        compliance_.index_bytes()}};
  if (supports_) parts.push_back({"moving supports", supports_->bytes()});
  if (published_) parts.push_back({"published motion", published_->bytes(), published_->detail()});
  return parts;
}

}  // namespace palpate::sim
