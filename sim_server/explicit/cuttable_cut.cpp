// How tissue in motion is cut: parts of CuttableMotion.
#include "sim_server/elasticity/element.h"
#include "sim_server/explicit/cuttable_motion.h"
#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {
namespace {

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

/// Those of these tetrahedra that are on the surface by now.
void CuttableMotion::show_corners(std::span<const int> tetrahedra, const CutMesh& remaining) {
  for (const int t : tetrahedra) {
    for (const int corner : remaining.mesh().tetrahedra[static_cast<std::size_t>(t)]) {
      const int vertex = remaining.number_of(corner);
      if (vertex < 0 || !remaining.on_surface(vertex) || state_.shown[static_cast<std::size_t>(vertex)] != 0)
        continue;
      state_.shown[static_cast<std::size_t>(vertex)] = 1;
      if (body_->first[static_cast<std::size_t>(vertex)] >= 0) state_.exposed.push_back(vertex);
    }
  }
}

/// Returns what is lost with a tetrahedron, its condensed corners where they are at rest.
CuttableModel::Removed CuttableMotion::lost_with(int tetrahedron, const CutMesh& remaining) const {
  const auto t = static_cast<std::size_t>(tetrahedron);
  const Tetrahedron& corners = remaining.mesh().tetrahedra[t];
  const std::vector<double>& factors = body_->tensors.mass_factors();
  const double mass =
      (factors.empty() ? 1 : factors[t]) * material_.density * six_volumes(remaining.mesh(), corners) / 6;
  std::array<Vec3, 4> x, u;
  Removed lost;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto vertex = static_cast<std::size_t>(corners[i]);
    x[i] = state_.rest_places[vertex];
    u[i].setZero();
    const int place = body_->tensors.places()[vertex];
    if (place < 0) continue;
    u[i] = body_->motion.turned_displacement(place);
    const Vec3 v = Eigen::Map<const Vec3>(body_->motion.state.v.data() + 3 * place);
    lost.kinetic += mass / 8 * v.squaredNorm();
    lost.momentum += mass / 4 * v;
  }
  const double stiffness = remaining.mesh().stiffness.empty() ? 1 : remaining.mesh().stiffness[t];
  lost.elastic = stiffness * linear_energy(LinearTetrahedron(x), u, material_);
  return lost;
}

/// Ends the contact of the last sub-step on the tissue that bore it.
void CuttableMotion::end_contact() noexcept {
  if (!state_.ended) end_sub_step();
  state_.ended = true;
  body_->motion.drop_next();
}

CuttableModel::Removed CuttableMotion::remove(std::span<const int> tetrahedra, const CutMesh& remaining) {
  end_contact();
  state_.changed = true;
  if (publisher_) publisher_->forget();
  if (body_->rest) body_->rest->observe(body_->motion.state.u, body_->motion.state.v);
  Removed removed;
  const auto add = [&removed](const Removed& lost) {
    removed.elastic += lost.elastic;
    removed.kinetic += lost.kinetic;
    removed.momentum += lost.momentum;
  };
  for (const int t : tetrahedra) add(lost_with(t, remaining));
  add(body_->remove(tetrahedra, remaining, material_));
  show_corners(tetrahedra, remaining);
  std::erase_if(state_.loads, [&](const VertexLoad& load) { return !remaining.on_surface(load.vertex); });
  return removed;
}

void CuttableMotion::part(std::span<const Slide> slides, const Parting& parting, const CutMesh& remaining) {
  end_contact();
  if (publisher_) publisher_->forget();
  body_->part(slides, parting, remaining, material_, scaling_.frequency);
  const auto place_again = [&](int vertex) {
    state_.rest_places[static_cast<std::size_t>(vertex)] =
        remaining.mesh().vertices[static_cast<std::size_t>(vertex)];
  };
  for (const Slide& slide : slides) place_again(slide.vertex);
  for (const Split& split : parting.splits) place_again(split.copy);
  show_corners(parting.tetrahedra, remaining);
  for (const Split& split : parting.splits)
    state_.shown[static_cast<std::size_t>(remaining.number_of(split.copy))] = 1;
  take_body();
  continue_with_body();
}

void CuttableMotion::release(std::span<const std::vector<int>> floating, const CutMesh& remaining) {
  end_contact();
  state_.changed = true;
  body_->release(floating, remaining.mesh());
}

/// Moves what is in motion to where the body says.
void CuttableMotion::continue_with_body() noexcept {
  update_free(state_.moving);
  become_free(state_.moving);
}

}  // namespace palpate::sim
