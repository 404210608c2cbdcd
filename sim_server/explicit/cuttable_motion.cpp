#include "sim_server/explicit/cuttable_motion.h"

#include <algorithm>
#include <cmath>

#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/statics/linear_statics.h"
#include "sim_server/statics/surface_compliance.h"
#include "sim_server/tissue/contact_instants.h"

namespace palpate::sim {
namespace {

constexpr double kAddedMass = 1e-2;    // of the mass in motion, for its stiffest elements
constexpr int kSubStepsPerSearch = 8;  // at what contact looks at of the rest without pressing there

const RayleighDamping& rayleigh_of(const Scene& scene) {
  return scene.deformation.of<RayleighDamping>();
}

/// Returns the scaling for all that may ever be in motion.
MassScaling scaling_for(const ModelInputs& inputs, const RegionInMotion* region) {
  step_period(inputs.scene);  // before any work
  require_held_tissue(inputs);
  require_no_loose_part(inputs);
  inputs.progress(name_of(Stage::kTensors), 0);
  std::vector<char> moves;
  if (region != nullptr) moves = region->vertices(inputs.mesh);
  const auto* const added = inputs.scene.deformation.find<AddedMass>();
  const double fraction = added == nullptr ? kAddedMass : added->fraction.value_or(kAddedMass);
  return scale_masses(inputs.mesh, *inputs.scene.material, fraction, moves);
}

}  // namespace

CuttableMotion::CuttableMotion(const ModelInputs& inputs) : CuttableMotion(inputs, nullptr) {}

CuttableMotion::CuttableMotion(const ModelInputs& inputs, const RegionInMotion& region)
    : CuttableMotion(inputs, &region) {}

CuttableMotion::CuttableMotion(const ModelInputs& inputs, const RegionInMotion* region)
    : material_(inputs.scene.material.value_or(Material{})),
      held_stiffness_(held_stiffness(inputs.scene)),
      scaling_(scaling_for(inputs, region)),
      node_(inputs.surface.vertices),
      nodes_(inputs.mesh.vertices) {
  state_.near = NearTools(inputs.surface.vertices.size());
  state_.rest_places = inputs.mesh.vertices;
  const std::vector<char> moves = region != nullptr ? region->vertices(inputs.mesh) : std::vector<char>();
  const CondensedPart::Modes modes{.most = region != nullptr ? region->condensed_modes : 0};
  body_ =
      std::make_unique<CuttableBody>(inputs, scaling_.factors, region != nullptr ? &moves : nullptr, modes);
  if (published_bodies(inputs.scene) > 0) publisher_.emplace(inputs, body_->tensors);
  choose_sub_step(inputs, body_->rest ? body_->rest->highest_frequency() : 0);
  for (const int vertex : node_) state_.free.push_back(state_.rest_places[static_cast<std::size_t>(vertex)]);
  state_.positions = state_.free;
  state_.loads.reserve(kMaxTools * node_.size());
  unloaded_.reserve(state_.loads.capacity());
  state_.loaded_vertices.reserve(state_.loads.capacity());
  state_.moving.reserve(node_.size());
  state_.exposed.reserve(node_.size());
  state_.moved.reserve(4 * node_.size());
  state_.shown.resize(node_.size());
  for (const Triangle& triangle : inputs.surface.triangles) {
    for (const int corner : triangle) state_.shown[static_cast<std::size_t>(corner)] = 1;
  }
  take_body();
}

/// Takes over another body than before.
void CuttableMotion::take_body() {
  state_.changed = true;
  state_.near.search_everywhere();
  state_.force.assign(body_->motion.state.f.size(), 0);
  state_.moving.clear();
  state_.exposed.clear();
  for (std::size_t v = 0; v < node_.size(); ++v) {
    if (body_->first[v] < 0) continue;
    state_.moving.push_back(static_cast<int>(v));
    if (state_.shown[v] != 0) state_.exposed.push_back(static_cast<int>(v));
  }
  make_compliance();
}

void CuttableMotion::make_compliance() {
  compliance_.emplace(body_->tensors, body_->first, body_->rest ? &*body_->rest : nullptr, sub_step_,
                      held_stiffness_);
}

ModelTraits CuttableMotion::traits() noexcept {
  return {.instants = instants_,
          .leading_force = true,
          .publishes_tangents = false,
          .added_mass = scaling_.fraction,
          .columns = &*compliance_,
          .cuttable = this,
          .client = publisher_ ? this : nullptr,
          .interior = body_->rest ? nullptr : this,
          .state = this};
}

std::any CuttableMotion::save() {
  Saved saved{state_, body_->tensors, body_->rest, body_->motion.save(), body_->first, {}};
  if (publisher_) saved.publisher = publisher_->save();
  return saved;
}

FreeMotion CuttableMotion::restore(const std::any& state) {
  const auto& saved = std::any_cast<const Saved&>(state);
  body_->motion.restore(saved.motion);
  body_->tensors = saved.tensors;
  if (saved.condensed) *body_->rest = *saved.condensed;
  body_->first = saved.first;
  state_ = saved.state;
  if (publisher_) publisher_->restore(*saved.publisher);
  make_compliance();
  return {.positions = state_.free, .loaded = state_.positions, .moved = &state_.moved};
}

/// Chooses the sub-step. `modes` (rad/s) bounds what the modes of the condensed part add to the frequency, in
/// squares.
void CuttableMotion::choose_sub_step(const ModelInputs& inputs, double modes) {
  const double longest = longest_sub_step(std::hypot(scaling_.frequency, modes), rayleigh_of(inputs.scene));
  instants_ = std::max(instants_of(inputs.scene.deformation, 1),
                       static_cast<int>(count_sub_steps(inputs.scene, longest)));
  sub_step_ = step_period(inputs.scene) / instants_;
}

void CuttableMotion::restrict_contact(std::span<const Neighbourhood> places,
                                      std::span<const Triangle> triangles) noexcept {
  constexpr double kFaster = 2;  // than anything on the surface is by now
  double fastest = 0;            // squared
  for (const int vertex : state_.exposed) {
    const int first = body_->first[static_cast<std::size_t>(vertex)];
    fastest = std::max(fastest, Eigen::Map<const Vec3>(body_->motion.state.v.data() + first).squaredNorm());
  }
  state_.instant = 0;  // also after a step that threw
  state_.near.search_in(places, triangles, body_->first, state_.free,
                        kFaster * std::sqrt(fastest) * sub_step_ * instants_);
  for (const VertexLoad& load : state_.loads) {
    if (body_->first[static_cast<std::size_t>(load.vertex)] >= 0) state_.near.add(load.vertex);
  }
  // None at all would mean that any may have moved.
  if (state_.near.vertices().empty() && !state_.exposed.empty()) state_.near.add(state_.exposed.front());
}

/// Contact begins to load a vertex in motion that it did not look at: that vertex is published from here on.
void CuttableMotion::observe(int vertex) noexcept {
  const bool published =
      !state_.near.narrowed() || state_.instant == 0 || body_->first[static_cast<std::size_t>(vertex)] < 0;
  if (published || !state_.near.add(vertex)) return;
  update_free({&vertex, 1});
  become_free({&vertex, 1});
  state_.moved.push_back(vertex);
}

FreeMotion CuttableMotion::free_motion(double dt) noexcept {
  if (dt > 0) {
    if (!state_.ended) end_sub_step();
    state_.ended = false;
    if (body_->rest && publisher_ && publisher_->surface() != nullptr)
      publisher_->surface()->motion.continue_(sub_step_, state_.loads);
    if (body_->rest) body_->pull_border(state_.changed, state_.force);
    take_sub_step();
    const bool ends = state_.instant + 1 == instants_;
    if (!ends) body_->motion.start_next();  // while contact is solved
    update_free(ends ? state_.moving : looked_at());
    if (body_->rest) carry_rest();
    state_.instant = (state_.instant + 1) % instants_;
    become_free(ends ? state_.moving : looked_at());
    note_moved();
    apply_loads();
  }
  return {.positions = state_.free, .loaded = state_.positions, .moved = &state_.moved};
}

/// Moves the condensed part with the border to the end of the sub-step, under constant loads on the border:
/// its loaded vertices, less often the others that contact searches, and all of it where a step ends.
void CuttableMotion::carry_rest() noexcept {
  const auto at = [&](const VertexLoad& load) {
    return Eigen::Map<Vec3>(body_->motion.state.u.data() +
                            body_->first[static_cast<std::size_t>(load.vertex)]);
  };
  const auto moves = [&](const VertexLoad& load) {
    return body_->first[static_cast<std::size_t>(load.vertex)] >= 0;
  };
  unloaded_.clear();
  for (const VertexLoad& load : state_.loads) {
    if (moves(load)) unloaded_.push_back(at(load));
  }
  for (const VertexLoad& load : state_.loads) {
    if (moves(load)) at(load) += sub_step_ * impulse_of(load);
  }
  body_->place_rest();
  auto before = unloaded_.begin();
  for (const VertexLoad& load : state_.loads) {
    if (moves(load)) at(load) = *before++;
  }
  const auto carry = [&](int vertex) {
    state_.free[static_cast<std::size_t>(vertex)] = rest_place(vertex) + body_->rest->carried(vertex);
  };
  if (state_.instant == 0) body_->rest->start_step();
  const bool ends = state_.instant + 1 == instants_;
  if (ends || state_.instant % kSubStepsPerSearch == 0)
    std::ranges::for_each(ends ? body_->rest->vertices() : body_->rest->watched(), carry);
  for (const VertexLoad& load : state_.loads) {
    if (body_->rest->has(load.vertex)) carry(load.vertex);
  }
}

/// Loads on the rest are handed down to the border, which takes them as forces of all of the sub-step.
void CuttableMotion::take_sub_step() noexcept {
  if (body_->rest) {
    std::ranges::copy(state_.force, body_->motion.state.f.begin());
    for (const VertexLoad& load : state_.loads) {
      if (body_->rest->has(load.vertex)) body_->rest->hand_down(load, body_->motion.state.f);
    }
    body_->rest->advance(sub_step_, state_.loads);
  }
  state_.changed ? body_->motion.run(sub_step_) : body_->motion.run_on(sub_step_);
  state_.changed = false;
}

/// Updates the visible positions in motion, and those of the condensed part that contact searches: all of
/// them where a step ends.
void CuttableMotion::note_moved() noexcept {
  const std::vector<int>& seen = state_.instant == 0 ? state_.exposed : looked_at();
  state_.moved.assign(seen.begin(), seen.end());
  if (body_->rest) {
    const auto rest = state_.instant == 0 ? body_->rest->vertices() : body_->rest->watched();
    state_.moved.insert(state_.moved.end(), rest.begin(), rest.end());
  }
  state_.watched = body_->rest ? body_->rest->watched().size() : 0;
  state_.moved_freely = state_.moved.size();
}

/// Updates the positions of these vertices, which are in motion, without loads.
void CuttableMotion::update_free(std::span<const int> vertices) noexcept {
  for (const int vertex : vertices) {
    const auto v = static_cast<std::size_t>(vertex);
    state_.free[v] = rest_place(static_cast<int>(v)) +
                     Eigen::Map<const Vec3>(body_->motion.state.u.data() + body_->first[v]);
  }
}

/// Ends a sub-step: what a load on a vertex in motion did over it adds to what all else did.
void CuttableMotion::end_sub_step() noexcept {
  for (const VertexLoad& load : state_.loads) {
    const int first = body_->first[static_cast<std::size_t>(load.vertex)];
    if (first < 0) continue;
    body_->motion.add_impulse(first / 3, sub_step_, impulse_of(load));
  }
}

void CuttableMotion::become_free(std::span<const int> vertices) noexcept {
  for (const int vertex : vertices)
    state_.positions[static_cast<std::size_t>(vertex)] = state_.free[static_cast<std::size_t>(vertex)];
}

/// Updates the condensed part where it is or was loaded, and where contact starts to search.
void CuttableMotion::note_loaded() noexcept {
  for (; body_->rest && state_.watched < body_->rest->watched().size(); ++state_.watched)
    state_.moved.push_back(body_->rest->watched()[state_.watched]);
  for (const int vertex : state_.loaded_vertices) {
    const auto loaded_vertices = std::span(state_.moved).subspan(state_.moved_freely);
    if (body_->first[static_cast<std::size_t>(vertex)] < 0 &&
        std::ranges::find(loaded_vertices, vertex) == loaded_vertices.end())
      state_.moved.push_back(vertex);
  }
}

/// Sets all other vertices to their positions without loads.
void CuttableMotion::apply_loads() noexcept {
  note_loaded();
  become_free(state_.loaded_vertices);
  state_.loaded_vertices.clear();
  for (const VertexLoad& load : state_.loads) state_.loaded_vertices.push_back(load.vertex);
  note_loaded();
  compliance_->move(state_.loads, state_.instant == 0, state_.free, state_.positions);
}

void CuttableMotion::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_->fill(vertices, patch);
}

std::span<const Vec3> CuttableMotion::apply(std::span<const VertexLoad> loads) noexcept {
  state_.loads.assign(loads.begin(), loads.end());
  for (const VertexLoad& load : state_.loads) {
    if (body_->rest) body_->rest->watch({&load.vertex, 1});
    observe(load.vertex);
  }
  apply_loads();
  return state_.positions;
}

std::span<const Vec3> CuttableMotion::nodes() const noexcept {
  if (body_->rest) return {};
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    const int place = body_->tensors.places()[node];
    if (place >= 0)
      nodes_[node] =
          state_.rest_places[node] + Eigen::Map<const Vec3>(body_->motion.state.u.data() + 3 * place);
  }
  for (std::size_t k = 0; !state_.ended && k < state_.loads.size(); ++k) {
    const auto vertex = static_cast<std::size_t>(state_.loads[k].vertex);
    if (body_->first[vertex] >= 0) nodes_[static_cast<std::size_t>(node_[vertex])] = state_.positions[vertex];
  }
  return nodes_;
}

}  // namespace palpate::sim
