#include "sim_server/deformation/cuttable_motion.h"

#include <algorithm>
#include <cmath>

#include "sim_server/deformation/contact_instants.h"
#include "sim_server/deformation/linear_statics.h"
#include "sim_server/deformation/surface_compliance.h"
#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {
namespace {

constexpr double kAddedMass = 1e-2;    // of the mass in motion, for its stiffest elements
constexpr int kSubStepsPerLook = 8;    // at what contact looks at of the rest without pressing there

const RayleighDamping& rayleigh_of(const Scene& scene) {
  return scene.deformation.of<RayleighDamping>();
}

/// For all that may ever be in motion.
MassScaling scaling_for(const ModelInputs& inputs, const RegionInMotion* region) {
  step_period(inputs.scene);  // before any work
  require_held_tissue(inputs);
  require_no_loose_part(inputs);
  inputs.progress(name_of(Stage::kTensors), 0);
  std::vector<char> moves;
  if (region != nullptr) moves = region->vertices(inputs.mesh);
  const auto* const added = inputs.scene.deformation.find<AddedMass>();
  const double share = added == nullptr ? kAddedMass : added->share.value_or(kAddedMass);
  return scale_masses(inputs.mesh, *inputs.scene.material, share, moves);
}

}  // namespace

CuttableMotion::CuttableMotion(const ModelInputs& inputs) : CuttableMotion(inputs, nullptr) {}

CuttableMotion::CuttableMotion(const ModelInputs& inputs, const RegionInMotion& region)
    : CuttableMotion(inputs, &region) {}

CuttableMotion::CuttableMotion(const ModelInputs& inputs, const RegionInMotion* region)
    : material_(inputs.scene.material.value_or(Material{})),
      held_stiffness_(held_stiffness(inputs.scene)),
      scaling_(scaling_for(inputs, region)),
      near_(inputs.surface.vertices.size()),
      node_(inputs.surface.vertices),
      rest_places_(inputs.mesh.vertices),
      nodes_(rest_places_) {
  const std::vector<char> moves =
      region != nullptr ? region->vertices(inputs.mesh) : std::vector<char>();
  const CondensedRest::Modes modes{.most = region != nullptr ? region->rest_modes : 0};
  body_ =
      std::make_unique<CuttableBody>(inputs, scaling_.factors, region != nullptr ? &moves : nullptr, modes);
  if (told_bodies(inputs.scene) > 0) told_.emplace(inputs, body_->tensors);
  choose_sub_step(inputs, body_->rest ? body_->rest->highest_frequency() : 0);
  for (const int vertex : node_) free_.push_back(rest_places_[static_cast<std::size_t>(vertex)]);
  positions_ = free_;
  loads_.reserve(kMaxTools * node_.size());
  kept_.reserve(loads_.capacity());
  pressed_.reserve(loads_.capacity());
  moving_.reserve(node_.size());
  exposed_.reserve(node_.size());
  moved_.reserve(4 * node_.size());
  shown_.resize(node_.size());
  for (const Triangle& triangle : inputs.surface.triangles) {
    for (const int corner : triangle) shown_[static_cast<std::size_t>(corner)] = 1;
  }
  look_at_body();
}

/// It is another one than before.
void CuttableMotion::look_at_body() {
  changed_ = true;
  near_.look_everywhere();
  force_.assign(body_->motion.state.f.size(), 0);
  moving_.clear();
  exposed_.clear();
  for (std::size_t v = 0; v < node_.size(); ++v) {
    if (body_->first[v] < 0) continue;
    moving_.push_back(static_cast<int>(v));
    if (shown_[v] != 0) exposed_.push_back(static_cast<int>(v));
  }
  compliance_.emplace(body_->tensors, body_->first, body_->rest ? &*body_->rest : nullptr, sub_step_,
                      held_stiffness_);
}

/// `modes` of the rest add at most so much, of squares; rad/s.
void CuttableMotion::choose_sub_step(const ModelInputs& inputs, double modes) {
  const double longest = longest_sub_step(std::hypot(scaling_.frequency, modes), rayleigh_of(inputs.scene));
  instants_ = std::max(instants_of(inputs.scene.deformation, 1),
                       static_cast<int>(count_sub_steps(inputs.scene, longest)));
  sub_step_ = step_period(inputs.scene) / instants_;
}

void CuttableMotion::narrow(std::span<const Neighbourhood> places,
                            std::span<const Triangle> triangles) noexcept {
  constexpr double kFaster = 2;  // than anything on the surface is by now
  double fastest = 0;            // squared
  for (const int vertex : exposed_) {
    const int first = body_->first[static_cast<std::size_t>(vertex)];
    fastest = std::max(fastest, Eigen::Map<const Vec3>(body_->motion.state.v.data() + first).squaredNorm());
  }
  instant_ = 0;  // also after a step that threw
  near_.look_in(places, triangles, body_->first, free_, kFaster * std::sqrt(fastest) * sub_step_ * instants_);
  for (const NodalLoad& load : loads_) {
    if (body_->first[static_cast<std::size_t>(load.vertex)] >= 0) near_.add(load.vertex);
  }
  // None at all would mean that any may have moved.
  if (near_.vertices().empty() && !exposed_.empty()) near_.add(exposed_.front());
}

/// Contact begins to load a vertex in motion that it did not look at: that is told from here on.
void CuttableMotion::look_at(int vertex) noexcept {
  const bool told = !near_.narrowed() || instant_ == 0 || body_->first[static_cast<std::size_t>(vertex)] < 0;
  if (told || !near_.add(vertex)) return;
  update_free({&vertex, 1});
  go_free({&vertex, 1});
  moved_.push_back(vertex);
}

FreeMotion CuttableMotion::free_motion(double dt) noexcept {
  if (dt > 0) {
    if (!ended_) end_sub_step();
    ended_ = false;
    if (body_->rest && told_ && told_->told() != nullptr) told_->told()->motion.go_on(sub_step_, loads_);
    if (body_->rest) follow();
    take_sub_step();
    const bool ends = instant_ + 1 == instants_;
    if (!ends) body_->motion.begin_next();  // while contact is solved
    update_free(ends ? moving_ : looked_at());
    if (body_->rest) carry_rest();
    instant_ = (instant_ + 1) % instants_;
    go_free(ends ? moving_ : looked_at());
    note_moved();
    press();
  }
  return {.positions = free_, .loaded = positions_, .moved = &moved_};
}

/// What the rest does on the border where both are by now.
void CuttableMotion::follow() noexcept {
  body_->rest->look_at(body_->motion.state.u, body_->motion.state.v);
  std::fill(force_.begin(), force_.end(), 0);
  body_->rest->follow(force_);
}

/// The rest goes to where the border takes it at the end of the sub-step, if loads on that stay as they are:
/// what is loaded, and, seldomer, what else contact looks at; all of it where a step ends.
void CuttableMotion::carry_rest() noexcept {
  const auto at = [&](const NodalLoad& load) {
    return Eigen::Map<Vec3>(body_->motion.state.u.data() +
                            body_->first[static_cast<std::size_t>(load.vertex)]);
  };
  const auto moves = [&](const NodalLoad& load) {
    return body_->first[static_cast<std::size_t>(load.vertex)] >= 0;
  };
  kept_.clear();
  for (const NodalLoad& load : loads_) {
    if (moves(load)) kept_.push_back(at(load));
  }
  for (const NodalLoad& load : loads_) {
    if (moves(load)) at(load) += sub_step_ * kick_of(load);
  }
  body_->rest->stand_at(body_->motion.state.u);
  auto before = kept_.begin();
  for (const NodalLoad& load : loads_) {
    if (moves(load)) at(load) = *before++;
  }
  const auto carry = [&](int vertex) {
    free_[static_cast<std::size_t>(vertex)] = rest_place(vertex) + body_->rest->carried(vertex);
  };
  if (instant_ == 0) body_->rest->begin_step();
  const bool ends = instant_ + 1 == instants_;
  if (ends || instant_ % kSubStepsPerLook == 0)
    std::ranges::for_each(ends ? body_->rest->vertices() : body_->rest->watched(), carry);
  for (const NodalLoad& load : loads_) {
    if (body_->rest->has(load.vertex)) carry(load.vertex);
  }
}

/// Loads on the rest are handed down to the border, which takes them as forces of all of the sub-step.
void CuttableMotion::take_sub_step() noexcept {
  if (body_->rest) {
    std::copy(force_.begin(), force_.end(), body_->motion.state.f.begin());
    for (const NodalLoad& load : loads_) {
      if (body_->rest->has(load.vertex)) body_->rest->hand_down(load, body_->motion.state.f);
    }
    body_->rest->advance(sub_step_, loads_);
  }
  changed_ ? body_->motion.run(sub_step_) : body_->motion.run_on(sub_step_);
  changed_ = false;
}

/// What is shown of what is in motion, and what contact looks at of the rest: where a step ends, all of that.
void CuttableMotion::note_moved() noexcept {
  const std::vector<int>& seen = instant_ == 0 ? exposed_ : looked_at();
  moved_.assign(seen.begin(), seen.end());
  if (body_->rest) {
    const auto rest = instant_ == 0 ? body_->rest->vertices() : body_->rest->watched();
    moved_.insert(moved_.end(), rest.begin(), rest.end());
  }
  watched_ = body_->rest ? body_->rest->watched().size() : 0;
  moved_by_itself_ = moved_.size();
}

/// Where these, in motion, go free of loads.
void CuttableMotion::update_free(std::span<const int> vertices) noexcept {
  for (const int vertex : vertices) {
    const auto v = static_cast<std::size_t>(vertex);
    free_[v] = rest_place(static_cast<int>(v)) +
               Eigen::Map<const Vec3>(body_->motion.state.u.data() + body_->first[v]);
  }
}

/// What a load on a vertex in motion does over the sub-step adds to what all else did.
void CuttableMotion::end_sub_step() noexcept {
  for (const NodalLoad& load : loads_) {
    const int first = body_->first[static_cast<std::size_t>(load.vertex)];
    if (first < 0) continue;
    body_->motion.kick(first / 3, sub_step_, kick_of(load));
  }
}

void CuttableMotion::go_free(std::span<const int> vertices) noexcept {
  for (const int vertex : vertices)
    positions_[static_cast<std::size_t>(vertex)] = free_[static_cast<std::size_t>(vertex)];
}

/// What is not in motion moves where it is pressed, and where it was; so does what contact begins to look at.
void CuttableMotion::note_pressed() noexcept {
  for (; body_->rest && watched_ < body_->rest->watched().size(); ++watched_)
    moved_.push_back(body_->rest->watched()[watched_]);
  for (const int vertex : pressed_) {
    const auto pressed = std::span(moved_).subspan(moved_by_itself_);
    if (body_->first[static_cast<std::size_t>(vertex)] < 0 &&
        std::ranges::find(pressed, vertex) == pressed.end())
      moved_.push_back(vertex);
  }
}

/// All else is where it is free.
void CuttableMotion::press() noexcept {
  note_pressed();
  go_free(pressed_);
  pressed_.clear();
  for (const NodalLoad& load : loads_) pressed_.push_back(load.vertex);
  note_pressed();
  compliance_->move(loads_, instant_ == 0, free_, positions_);
}

void CuttableMotion::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_->fill(vertices, patch);
}

std::span<const Vec3> CuttableMotion::apply(std::span<const NodalLoad> loads) noexcept {
  loads_.assign(loads.begin(), loads.end());
  for (const NodalLoad& load : loads_) {
    if (body_->rest) body_->rest->watch({&load.vertex, 1});
    look_at(load.vertex);
  }
  press();
  return positions_;
}

std::span<const Vec3> CuttableMotion::nodes() const noexcept {
  if (body_->rest) return {};
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    const int place = body_->tensors.places()[node];
    if (place >= 0)
      nodes_[node] = rest_places_[node] + Eigen::Map<const Vec3>(body_->motion.state.u.data() + 3 * place);
  }
  for (std::size_t k = 0; !ended_ && k < loads_.size(); ++k) {
    const auto vertex = static_cast<std::size_t>(loads_[k].vertex);
    if (body_->first[vertex] >= 0) nodes_[static_cast<std::size_t>(node_[vertex])] = positions_[vertex];
  }
  return nodes_;
}

}  // namespace palpate::sim
