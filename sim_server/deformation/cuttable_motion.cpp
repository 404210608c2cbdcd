#include "sim_server/deformation/cuttable_motion.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "sim_server/deformation/contact_instants.h"
#include "sim_server/deformation/linear_statics.h"
#include "sim_server/deformation/surface_compliance.h"
#include "sim_server/elasticity/element.h"
#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {
namespace {

constexpr double kMostAddedMass = 1e-2;  // of the mass in motion, for its stiffest elements
constexpr int kSubStepsPerLook = 8;      // at what contact looks at of the rest without pressing there

const RayleighDamping& rayleigh_of(const Scene& scene) {
  return scene.deformation.of<RayleighDamping>();
}

MassScaling scaling_for(const ModelInputs& inputs, const std::vector<char>* moves) {
  step_period(inputs.scene);  // before any work
  require_held_tissue(inputs);
  require_no_loose_part(inputs);
  inputs.progress(name_of(Stage::kTensors), 0);
  return scale_masses(inputs.mesh, *inputs.scene.material, kMostAddedMass,
                      moves != nullptr ? std::span<const char>(*moves) : std::span<const char>());
}

/// Vertices that are fixed or not in motion, ascending.
std::vector<int> standing(const ModelInputs& inputs, const std::vector<char>* moves) {
  std::vector<int> still = inputs.fixed;
  for (std::size_t v = 0; moves != nullptr && v < moves->size(); ++v) {
    if ((*moves)[v] == 0) still.push_back(static_cast<int>(v));
  }
  std::sort(still.begin(), still.end());
  still.erase(std::unique(still.begin(), still.end()), still.end());
  return still;
}

/// Elastic energy of an element whose corners are displaced by `u` (m), J.
double linear_energy(const LinearTetrahedron& element, const std::array<Vec3, 4>& u,
                     const Material& material) {
  Mat3 F = Mat3::Identity();
  for (std::size_t i = 0; i < 4; ++i) F += u[i] * element.gradient[i].transpose();
  const Moduli moduli = LinearLaw::moduli(material);
  const LinearLaw law(moduli, F);
  return element.volume * (law.shape_energy() + 0.5 * moduli.lambda * law.dilation() * law.dilation());
}

}  // namespace

CuttableMotion::CuttableMotion(const ModelInputs& inputs) : CuttableMotion(inputs, nullptr, 0) {}

CuttableMotion::CuttableMotion(const ModelInputs& inputs, const std::vector<char>& moves, int rest_modes)
    : CuttableMotion(inputs, &moves, rest_modes) {}

CuttableMotion::CuttableMotion(const ModelInputs& inputs, const std::vector<char>* moves, int rest_modes)
    : material_(inputs.scene.material.value_or(Material{})),
      scaling_(scaling_for(inputs, moves)),
      tensors_(inputs.mesh, material_, standing(inputs, moves), scaling_.factors),
      motion_(tensors_, rayleigh_of(inputs.scene)),
      force_(motion_.state.f),
      node_(inputs.surface.vertices),
      rest_places_(inputs.mesh.vertices),
      nodes_(rest_places_) {
  if (moves != nullptr) {
    rest_.emplace(inputs, tensors_.places(), rest_modes);
    for (const auto& [first, kg] : rest_->border_masses()) tensors_.add_mass(first / 3, kg);
  }
  choose_sub_step(inputs);
  for (const int vertex : node_) {
    free_.push_back(inputs.mesh.vertices[static_cast<std::size_t>(vertex)]);
    const int place = tensors_.places()[static_cast<std::size_t>(vertex)];
    first_.push_back(place < 0 ? -1 : 3 * place);
  }
  positions_ = free_;
  loads_.reserve(kMaxTools * node_.size());
  kept_.reserve(loads_.capacity());
  compliance_.emplace(tensors_, first_, rest_ ? &*rest_ : nullptr, sub_step_, held_stiffness(inputs.scene));
}

void CuttableMotion::choose_sub_step(const ModelInputs& inputs) {
  const double modes = rest_ ? rest_->highest_frequency() : 0;  // adds at most so much (of squares)
  const double longest = longest_sub_step(std::hypot(scaling_.frequency, modes), rayleigh_of(inputs.scene));
  instants_ = std::max(instants_of(inputs.scene.deformation, 1),
                       static_cast<int>(count_sub_steps(inputs.scene, longest)));
  sub_step_ = step_period(inputs.scene) / instants_;
}

FreeMotion CuttableMotion::free_motion(double dt) noexcept {
  if (dt > 0) {
    if (!ended_) end_sub_step();
    ended_ = false;
    if (rest_) follow();
    take_sub_step();
    update_free();
    if (rest_) carry_rest();
    instant_ = (instant_ + 1) % instants_;
    press();
  }
  return {.positions = free_, .loaded = positions_};
}

/// What the rest does on the border where both are by now.
void CuttableMotion::follow() noexcept {
  rest_->look_at(motion_.state.u, motion_.state.v);
  std::fill(force_.begin(), force_.end(), 0);
  rest_->follow(force_);
}

/// The rest goes to where the border takes it at the end of the sub-step, if loads on that stay as they are:
/// what is loaded, and, seldomer, what else contact looks at; all of it where a step ends.
void CuttableMotion::carry_rest() noexcept {
  const auto at = [&](const NodalLoad& load) {
    return Eigen::Map<Vec3>(motion_.state.u.data() + first_[static_cast<std::size_t>(load.vertex)]);
  };
  const auto moves = [&](const NodalLoad& load) {
    return first_[static_cast<std::size_t>(load.vertex)] >= 0;
  };
  kept_.clear();
  for (const NodalLoad& load : loads_) {
    if (moves(load)) kept_.push_back(at(load));
  }
  for (const NodalLoad& load : loads_) {
    if (moves(load)) at(load) += sub_step_ * kick_of(load);
  }
  rest_->stand_at(motion_.state.u);
  auto before = kept_.begin();
  for (const NodalLoad& load : loads_) {
    if (moves(load)) at(load) = *before++;
  }
  const auto carry = [&](int vertex) {
    free_[static_cast<std::size_t>(vertex)] = rest_place(vertex) + rest_->carried(vertex);
  };
  if (instant_ == 0) rest_->begin_step();
  const bool ends = instant_ + 1 == instants_;
  if (ends || instant_ % kSubStepsPerLook == 0)
    std::ranges::for_each(ends ? rest_->vertices() : rest_->watched(), carry);
  for (const NodalLoad& load : loads_) {
    if (rest_->has(load.vertex)) carry(load.vertex);
  }
}

/// Loads on the rest are handed down to the border, which takes them as forces of all of the sub-step.
void CuttableMotion::take_sub_step() noexcept {
  std::copy(force_.begin(), force_.end(), motion_.state.f.begin());
  for (const NodalLoad& load : loads_) {
    if (rest_ && rest_->has(load.vertex)) rest_->hand_down(load, motion_.state.f);
  }
  if (rest_) rest_->advance(sub_step_, loads_);
  motion_.run(sub_step_);
}

/// Where what is in motion goes free of loads.
void CuttableMotion::update_free() noexcept {
  for (std::size_t v = 0; v < free_.size(); ++v) {
    if (first_[v] >= 0)
      free_[v] = rest_place(static_cast<int>(v)) + Eigen::Map<const Vec3>(motion_.state.u.data() + first_[v]);
  }
}

/// What a load on a vertex in motion does over the sub-step adds to what all else did.
void CuttableMotion::end_sub_step() noexcept {
  for (const NodalLoad& load : loads_) {
    const int first = first_[static_cast<std::size_t>(load.vertex)];
    if (first < 0) continue;
    const Vec3 kick = kick_of(load);
    Eigen::Map<Vec3>(motion_.state.v.data() + first) += kick;
    Eigen::Map<Vec3>(motion_.state.u.data() + first) += sub_step_ * kick;
  }
}

void CuttableMotion::press() noexcept {
  std::copy(free_.begin(), free_.end(), positions_.begin());
  compliance_->move(loads_, instant_ == 0, positions_);
}

void CuttableMotion::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_->fill(vertices, patch);
}

std::span<const Vec3> CuttableMotion::apply(std::span<const NodalLoad> loads) noexcept {
  loads_.assign(loads.begin(), loads.end());
  press();
  return positions_;
}

std::span<const Vec3> CuttableMotion::nodes() const noexcept {
  if (rest_) return {};
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    const int place = tensors_.places()[node];
    if (place >= 0)
      nodes_[node] = rest_places_[node] + Eigen::Map<const Vec3>(motion_.state.u.data() + 3 * place);
  }
  for (std::size_t k = 0; !ended_ && k < loads_.size(); ++k) {
    const auto vertex = static_cast<std::size_t>(loads_[k].vertex);
    if (first_[vertex] >= 0) nodes_[static_cast<std::size_t>(node_[vertex])] = positions_[vertex];
  }
  return nodes_;
}

/// Of a tetrahedron, with its corners that are condensed where they are at rest.
DeformationModel::Removed CuttableMotion::lost_with(int tetrahedron, const CutMesh& left) const {
  const auto t = static_cast<std::size_t>(tetrahedron);
  const Tetrahedron& corners = left.mesh().tetrahedra[t];
  const double mass = material_.density * six_volumes(left.mesh(), corners) / 6;
  std::array<Vec3, 4> x, u;
  Removed lost;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto vertex = static_cast<std::size_t>(corners[i]);
    x[i] = rest_places_[vertex];
    u[i].setZero();
    const int place = tensors_.places()[vertex];
    if (place < 0) continue;
    u[i] = Eigen::Map<const Vec3>(motion_.state.u.data() + 3 * place);
    const Vec3 v = Eigen::Map<const Vec3>(motion_.state.v.data() + 3 * place);
    lost.kinetic += mass / 8 * v.squaredNorm();
    lost.momentum += mass / 4 * v;
  }
  const double stiffness = left.mesh().stiffness.empty() ? 1 : left.mesh().stiffness[t];
  lost.elastic = stiffness * linear_energy(LinearTetrahedron(x), u, material_);
  return lost;
}

/// What the contact of the last sub-step did is done first, by the tissue that bore it.
DeformationModel::Removed CuttableMotion::remove(std::span<const int> tetrahedra, const CutMesh& left) {
  if (!ended_) end_sub_step();
  ended_ = true;
  if (rest_) rest_->look_at(motion_.state.u, motion_.state.v);
  Removed gone;
  for (const int t : tetrahedra) {
    const Removed lost = lost_with(t, left);
    gone.elastic += lost.elastic;
    gone.kinetic += lost.kinetic;
    gone.momentum += lost.momentum;
    for (const int v : left.mesh().tetrahedra[static_cast<std::size_t>(t)]) {
      if (!rest_ || rest_->part_of(v) < 0) continue;
      const Removed part = rest_->remove(rest_->part_of(v));
      gone.elastic += part.elastic;
      gone.kinetic += part.kinetic;
    }
  }
  tensors_.remove(tetrahedra, left, material_);
  for (const int t : tetrahedra) {
    for (const int v : left.mesh().tetrahedra[static_cast<std::size_t>(t)]) {
      const int place = tensors_.places()[static_cast<std::size_t>(v)];
      const auto is_left = [&](int other) { return left.is_left(other); };
      if (place >= 0 && std::ranges::none_of(left.around(v), is_left))  // else it would drift for ever
        Eigen::Map<Vec3>(motion_.state.v.data() + 3 * place).setZero();
    }
  }
  std::erase_if(loads_, [&](const NodalLoad& load) { return !left.on_surface(load.vertex); });
  return gone;
}

std::vector<MemoryPart> CuttableMotion::memory() const {
  std::vector<MemoryPart> parts{
      {"tensors", tensors_.bytes(),
       fmt::format("{} vertices, {} edges; {} sub-steps of {:.3g} ms; {:.2g} g more for stiff elements",
                   tensors_.vertices(), tensors_.edges(), instants_, 1e3 * sub_step_, 1e3 * scaling_.added)},
      {"motion", motion_.bytes() + force_.size() * sizeof(double)},
      {"positions", (free_.size() + positions_.size() + 2 * nodes_.size() + kept_.capacity()) * sizeof(Vec3) +
                        loads_.capacity() * sizeof(NodalLoad) +
                        (first_.size() + node_.size()) * sizeof(int)}};
  if (rest_)
    parts.push_back({"condensed rest", rest_->bytes(),
                     fmt::format("{} parts, {} modes, {} vertices at the border, {} that tools reach",
                                 rest_->parts(), rest_->modes(), rest_->border(), rest_->vertices().size())});
  return parts;
}

}  // namespace palpate::sim
