#include "sim_server/models/implicit.h"

#include <algorithm>
#include <utility>

#include "common/error.h"
#include "sim_server/scene/held_motion.h"
#include "sim_server/solvers/equilibrium.h"
#include "sim_server/statics/linear_statics.h"
#include "sim_server/tissue/rayleigh_damping.h"

namespace palpate::sim {
namespace {

constexpr double kBalanced = 0.01;  // relative residual of the last iteration of a step that counts as solved
constexpr int kMoreIterations = 3;  // times `max_newton`, where the residual does not count as solved by then
constexpr double kMostColumnBytes = 1e9;  // of columns, when a step begins

/// A body that nothing holds flies.
DynamicsSettings settings_of(const ModelInputs& inputs) {
  DynamicsSettings settings = dynamics_settings(inputs.scene.deformation);
  settings.flies = inputs.scene.flies();
  settings.cut = inputs.scene.cutting.has_value();
  return settings;
}

/// True if its [[fixed]], held along all axes, are all that holds the body.
bool held_by_vertices(const Scene& scene) {
  const auto displaces = [](const Load& load) { return load.kind == Load::Kind::kDisplacement; };
  const auto on_rails = [](const FixedRegion& fixed) { return fixed.axes != kAllAxes; };
  return !scene.fixed.empty() && std::ranges::none_of(scene.fixed, on_rails) &&
         std::ranges::none_of(scene.loads, displaces);
}

/// True if slow modes about rest are published: of a body that only tools move, or also supports of
/// which it is known how it follows them.
bool publishes_modes(const ModelInputs& inputs) {
  const auto* const published = inputs.scene.deformation.find<ClientModes>();
  return published != nullptr && published->modes > 0 && !inputs.scene.cutting &&
         inputs.scene.loads.empty() && held_by_vertices(inputs.scene) &&
         inputs.scene.material->relaxations.size() <= kMostRelaxations &&
         (!supports_move(inputs.scene) || inputs.scene.material->is_linear());
}

/// Returns, of each node, its place among the free ones, or -1.
std::vector<int> places_of(const LinearStatics& statics) {
  std::vector<int> places;
  for (const int first : statics.dofs.first) places.push_back(first < 0 ? -1 : first / 3);
  return places;
}

/// Returns the mass of each of these places, kg.
std::vector<double> masses_of_places(const LinearStatics& statics) {
  const Eigen::VectorXd masses = statics.masses();
  std::vector<double> of_places;
  for (Eigen::Index i = 0; i < masses.size(); i += 3) of_places.push_back(masses[i]);
  return of_places;
}

const Material& material_of(const ModelInputs& inputs) {
  const Scene& scene = inputs.scene;
  if (!scene.material) fail("{}: model \"implicit\" needs a [material] section", scene.source);
  step_period(scene);  // before any work
  if (held_by_vertices(scene)) require_no_loose_part(inputs);
  inputs.progress(name_of(Stage::kStiffness), 0);
  return *scene.material;
}

}  // namespace

double Implicit::estimated_bytes(const Scene& scene, const MeshCounts& counts) {
  const ElementKind element = scene.material->element;
  // To find the shape under loads or on supports that move, of now and at rest besides.
  const bool loaded = !scene.loads.empty() || supports_move(scene);
  const double bytes = body_bytes(counts, element, loaded ? 3 : 1);
  const bool background =
      scene.deformation.of<ImplicitSettings>().solver != DynamicsSettings::Solver::kDirect;
  const bool publishes = scene.deformation.find<ClientModes>() != nullptr;  // it may
  return bytes + (background ? matrix_bytes(counts, element) : 0) +
         (publishes ? body_bytes(counts, element, 1) : 0);
}

Implicit::Implicit(const ModelInputs& inputs)
    : may_be_cut_(inputs.scene.cutting.has_value()),
      solid_(inputs.mesh, material_of(inputs)),
      scene_loads_(inputs.scene, inputs.mesh, inputs.surface, solid_),
      dynamics_(solid_, scene_loads_.held(), settings_of(inputs), inputs.scene.source),
      held_compliance_(1 / held_stiffness(inputs.scene)),
      settings_(inputs.scene.deformation.of<ImplicitSettings>()),
      instants_(instants_of(inputs.scene.deformation, 1)),
      period_(step_period(inputs.scene) / instants_),
      node_(inputs.surface.vertices),
      external_(static_cast<std::size_t>(solid_.nodes())) {
  columns_.slot.assign(node_.size(), -1);
  columns_.requested.resize(node_.size());
  begin(inputs);
  inputs.progress(name_of(Stage::kFactor), 0);
  std::vector<Vec3> rest;
  for (const int node : node_) {
    dof_.push_back(dynamics_.dofs().first[node]);
    rest.push_back(dynamics_.position()[node]);
  }
  vertex_.assign(static_cast<std::size_t>(dynamics_.dofs().count / 3), -1);
  for (std::size_t v = 0; v < dof_.size(); ++v) {
    if (dof_[v] >= 0) vertex_[static_cast<std::size_t>(dof_[v] / 3)] = static_cast<int>(v);
  }
  if (inputs.scene.deformation.of<ImplicitSettings>().solver != DynamicsSettings::Solver::kDirect)
    triangles_ = inputs.surface.triangles;
  if (publishes_modes(inputs)) {
    const LinearStatics statics(inputs);
    published_.emplace(inputs, statics, places_of(statics), masses_of_places(statics));
    if (!published_->modes().relaxations.empty()) relaxation_.emplace(published_->modes());
  }
  free_ = positions_ = rest;
  dynamics_.start_step(period_);
  dynamics_.iterate(external_forces());
  update_surface();
  if (supports_ || inputs.scene.flies()) free_ = positions_ = rest;
  inputs.progress(name_of(Stage::kFactor), 1);
}

/// Sets where the body is at time 0, and how fast it goes.
void Implicit::begin(const ModelInputs& inputs) {
  const auto flexibility = [this](const Eigen::MatrixXd& f) { return dynamics_.factor().matrix().solve(f); };
  const auto responses =
      support_responses(inputs, solid_, dynamics_.dofs(), flexibility, Following::kSwinging);
  if (!responses.empty()) supports_.emplace(inputs, responses);
  if (publishes_modes(inputs)) responses_ = responses;
  if (inputs.scene.flies() || (inputs.scene.loads.empty() && !supports_)) return;
  inputs.progress(name_of(Stage::kLoadedShape), 0);
  const StaticLoad load{
      .forces = [this](std::span<const Vec3> x, std::span<Vec3> f) { scene_loads_.add_forces(x, f); },
      .held = scene_loads_.held(),
      .moved = scene_loads_.moved()};
  std::vector<Vec3> x = solid_.rest(), v(x.size(), Vec3::Zero());
  for (const SupportResponse& response : responses) response.add(0, x, v);
  dynamics_.set_state(find_equilibrium(solid_, load, inputs.scene.source).x, v);
}

FreeMotion Implicit::free_motion(double dt) {
  if (dt > 0) {
    if (step_.in_step) {
      apply_new_loads();
      dynamics_.finish_step();
      if (relaxation_) store();
    }
    step_.in_step = true;
    step_.relinearised = false;
    if (static_cast<double>(columns_.values.size()) * sizeof(double) > kMostColumnBytes) clear_columns();
    if (!triangles_.empty()) request_columns();
    dynamics_.start_step(period_);
    if (supports_) {
      supports_->advance(period_);
      scene_loads_.put_held(supports_->time(), dynamics_.mutable_position());
    }
    linearised_loads_ = loads_;
    step_.iterations = dynamics_.solve(external_forces(), 1, settings_.tolerance);
    if (dynamics_.relative_residual() <= std::max(settings_.tolerance, Dynamics::kAtRest) && !is_linear())
      dynamics_.refactor_if_moved();
    update_surface();
  }
  return motion();
}

FreeMotion Implicit::motion() const {
  if (!supports_) return {.positions = free_, .loaded = positions_};
  return {.positions = free_,
          .velocities = supports_->velocities(),
          .loaded = positions_,
          .carried = published_ ? supports_->positions() : std::span<const Vec3>()};
}

/// Moves all of the body by what the linearisation predicts of the loads that are new to it.
void Implicit::apply_new_loads() {
  if (loads_ == linearised_loads_) return;
  Eigen::VectorXd change = Eigen::VectorXd::Zero(dynamics_.dofs().count);
  add_response(loads_, 1, change);
  add_response(linearised_loads_, -1, change);
  linearised_loads_ = loads_;
  dynamics_.apply_increment(change, external_forces());
}

/// Adds the displacement (m, by unknowns) that loads cause by the linearisation, times `sign`.
void Implicit::add_response(std::span<const VertexLoad> loads, double sign, Eigen::VectorXd& moved) const {
  std::vector<int> vertices;
  for (const VertexLoad& load : loads) vertices.push_back(load.vertex);
  find_columns(vertices);
  for (const VertexLoad& load : loads) {
    if (dof_[load.vertex] >= 0)
      moved += columns_.values.middleCols<3>(3 * columns_.slot[load.vertex]) * (sign * load.force);
  }
}

std::optional<FreeMotion> Implicit::relinearise() {
  const bool is_near = dynamics_.relative_residual() <= kBalanced;
  const int most = is_near ? settings_.max_newton : kMoreIterations * settings_.max_newton;
  if (is_linear() || ++step_.iterations > most) return {};
  apply_new_loads();
  if (!step_.relinearised) dynamics_.loads_changed();
  step_.relinearised = true;
  if (dynamics_.iterate(external_forces(), settings_.tolerance) <= settings_.tolerance) return {};
  update_surface();
  return motion();
}

NonlinearModel::Balance Implicit::balance() const noexcept {
  if (is_linear()) return Balance::kBalanced;
  if (dynamics_.inside_out()) return Balance::kInsideOut;
  return dynamics_.relative_residual() <= kBalanced ? Balance::kBalanced : Balance::kUnbalanced;
}

ModelTraits Implicit::traits() noexcept {
  return {.instants = instants_,
          .nonlinear = is_linear() ? nullptr : this,
          .cuttable = may_be_cut_ ? this : nullptr,
          .client = published_ ? this : nullptr,
          .later = this,
          .interior = this,
          .state = this};
}

std::any Implicit::save() {
  dynamics_.wait();
  State state{solid_,   dynamics_, {},         relaxation_, step_,
              columns_, free_,     positions_, loads_,      linearised_loads_};
  if (supports_) state.supports = supports_->state();
  return state;
}

FreeMotion Implicit::restore(const std::any& saved) {
  const auto& state = std::any_cast<const State&>(saved);
  dynamics_.wait();
  solid_ = state.solid;
  dynamics_ = state.dynamics;
  relaxation_ = state.relaxation;
  step_ = state.progress;
  columns_ = state.columns;
  free_ = state.free;
  positions_ = state.positions;
  loads_ = state.loads;
  linearised_loads_ = state.linearised_loads;
  if (supports_) supports_->set_state(*state.supports);
  return motion();
}

/// Updates the surface after each iteration: at the trial point, and without the loads that the linearisation
/// was made under. Drops the columns of another factor.
void Implicit::update_surface() {
  if (step_.factors != dynamics_.factor().count()) {
    step_.factors = dynamics_.factor().count();
    replace_columns();
  }
  for (std::size_t v = 0; v < node_.size(); ++v) positions_[v] = dynamics_.position()[node_[v]];
  for (const VertexLoad& load : linearised_loads_) {  // what holds the body is no part of its motion
    if (dof_[load.vertex] < 0) positions_[load.vertex] += held_compliance_ * load.force;
  }
  std::ranges::copy(positions_, free_.begin());
  apply_loads(linearised_loads_, -1, free_);
}

/// Returns the forces of the scene and of the tools at the trial point (nodes, N).
std::span<const Vec3> Implicit::external_forces() {
  std::ranges::fill(external_, Vec3::Zero());
  scene_loads_.add_forces(dynamics_.position(), external_);
  for (const VertexLoad& load : linearised_loads_) external_[node_[load.vertex]] += load.force;
  return external_;
}

/// Has the next factor of the background come with the columns asked for since the last one, and with those
/// around them, which a tool that slides will need.
void Implicit::request_columns() {
  std::vector<std::uint8_t> near = columns_.requested;
  for (const Triangle& t : triangles_) {
    if ((columns_.requested[t[0]] | columns_.requested[t[1]] | columns_.requested[t[2]]) != 0)
      near[t[0]] = near[t[1]] = near[t[2]] = 1;
  }
  std::vector<int> first;
  for (std::size_t v = 0; v < dof_.size(); ++v) {
    if (near[v] != 0 && dof_[v] >= 0) first.push_back(dof_[v]);
  }
  dynamics_.request_columns(std::move(first));
}

/// Frees the memory of all columns; those that are asked for again are solved for again.
void Implicit::clear_columns() {
  std::ranges::fill(columns_.slot, -1);
  columns_.slots = 0;
  columns_.values.resize(0, 0);
}

/// Drops the columns of the last factor for those that came with the new one, if any did.
void Implicit::replace_columns() {
  std::ranges::fill(columns_.slot, -1);
  std::ranges::fill(columns_.requested, std::uint8_t{0});
  columns_.slots = 0;
  const Columns& ready = dynamics_.factor().background_columns();
  for (std::size_t k = 0; k < ready.first.size(); ++k)
    columns_.slot[vertex_[static_cast<std::size_t>(ready.first[k] / 3)]] = static_cast<int>(k);
  if (!ready.first.empty()) keep_columns(ready.values);
}

void Implicit::find_columns(std::span<const int> vertices) const {
  std::vector<int> missing;
  for (const int v : vertices) {
    columns_.requested[v] = 1;
    if (dof_[v] < 0 || columns_.slot[v] >= 0) continue;
    columns_.slot[v] = columns_.slots + static_cast<int>(missing.size());
    missing.push_back(dof_[v]);
  }
  if (missing.empty()) return;
  keep_columns(dynamics_.factor().matrix().columns(missing, settings_.column_tolerance()));
}

void Implicit::keep_columns(const Eigen::MatrixXd& columns) const {
  const Eigen::Index before = 3 * columns_.slots;
  if (columns_.values.cols() < before + columns.cols())
    columns_.values.conservativeResize(dynamics_.dofs().count, 2 * (before + columns.cols()));
  columns_.values.middleCols(before, columns.cols()) = columns;
  columns_.slots += static_cast<int>(columns.cols() / 3);
}

void Implicit::compliance(std::span<const int> vertices, ContactPatch& patch) const {
  patch.tool_compliance = 0;
  find_columns(vertices);
  const auto m = static_cast<Eigen::Index>(vertices.size());
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      auto block = patch.compliance.block<3, 3>(3 * i, 3 * j);
      if (dof_[vertices[i]] < 0 || dof_[vertices[j]] < 0) {
        block = (i == j ? held_compliance_ : 0.0) * Mat3::Identity();
      } else {
        // Equal by theory to its mirror image; make it so to the last bit.
        block = 0.5 *
                (columns_.values.block<3, 3>(dof_[vertices[i]], 3 * columns_.slot[vertices[j]]) +
                 columns_.values.block<3, 3>(dof_[vertices[j]], 3 * columns_.slot[vertices[i]]).transpose());
      }
      if (i != j) patch.compliance.block<3, 3>(3 * j, 3 * i) = block.transpose();
    }
  }
}

/// Moves `positions` (surface vertices, m) by the displacement that loads cause, times `sign`.
void Implicit::apply_loads(std::span<const VertexLoad> loads, double sign, std::span<Vec3> positions) const {
  if (loads.empty()) return;
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(dynamics_.dofs().count);
  add_response(loads, sign, moved);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (dof_[v] >= 0) positions[v] += moved.segment<3>(dof_[v]);
  }
  for (const VertexLoad& load : loads) {
    if (dof_[load.vertex] < 0) positions[load.vertex] += sign * held_compliance_ * load.force;
  }
}

std::span<const Vec3> Implicit::apply(std::span<const VertexLoad> loads) {
  loads_.assign(loads.begin(), loads.end());
  std::ranges::copy(free_, positions_.begin());
  apply_loads(loads_, 1, positions_);
  return positions_;
}

std::vector<MemoryPart> Implicit::memory() const {
  std::vector<MemoryPart> parts{
      {"elements", solid_.bytes() + dynamics_.scratch_bytes()},
      {"motion", dynamics_.bytes()},
      {"compliance", static_cast<std::size_t>(columns_.values.size()) * sizeof(double)},
      {"positions", (free_.size() + positions_.size() + external_.size()) * sizeof(Vec3) +
                        (node_.size() + dof_.size() + columns_.slot.size()) * sizeof(int)}};
  if (supports_)
    parts.push_back({"moving supports", supports_->bytes() + 2 * responses_.size() *
                                                                 static_cast<std::size_t>(solid_.nodes()) *
                                                                 sizeof(Vec3)});
  if (published_)
    parts.push_back({"published motion", published_->bytes() + (relaxation_ ? relaxation_->bytes() : 0),
                     published_->detail()});
  return parts;
}

}  // namespace palpate::sim
