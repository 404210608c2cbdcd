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
void CuttableMotion::show_corners(std::span<const int> tetrahedra, const CutMesh& left) {
  for (const int t : tetrahedra) {
    for (const int corner : left.mesh().tetrahedra[static_cast<std::size_t>(t)]) {
      const int vertex = left.number_of(corner);
      if (vertex < 0 || !left.on_surface(vertex) || state_.shown[static_cast<std::size_t>(vertex)] != 0)
        continue;
      state_.shown[static_cast<std::size_t>(vertex)] = 1;
      if (body_->first[static_cast<std::size_t>(vertex)] >= 0) state_.exposed.push_back(vertex);
    }
  }
}

/// Of a tetrahedron, with its corners that are condensed where they are at rest.
CuttableModel::Removed CuttableMotion::lost_with(int tetrahedron, const CutMesh& left) const {
  const auto t = static_cast<std::size_t>(tetrahedron);
  const Tetrahedron& corners = left.mesh().tetrahedra[t];
  const std::vector<double>& factors = body_->tensors.mass_factors();
  const double mass =
      (factors.empty() ? 1 : factors[t]) * material_.density * six_volumes(left.mesh(), corners) / 6;
  std::array<Vec3, 4> x, u;
  Removed lost;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto vertex = static_cast<std::size_t>(corners[i]);
    x[i] = state_.rest_places[vertex];
    u[i].setZero();
    const int place = body_->tensors.places()[vertex];
    if (place < 0) continue;
    u[i] = Eigen::Map<const Vec3>(body_->motion.state.u.data() + 3 * place);
    const Vec3 v = Eigen::Map<const Vec3>(body_->motion.state.v.data() + 3 * place);
    lost.kinetic += mass / 8 * v.squaredNorm();
    lost.momentum += mass / 4 * v;
  }
  const double stiffness = left.mesh().stiffness.empty() ? 1 : left.mesh().stiffness[t];
  lost.elastic = stiffness * linear_energy(LinearTetrahedron(x), u, material_);
  return lost;
}

/// What the contact of the last sub-step did is done by the tissue that bore it.
void CuttableMotion::end_contact() noexcept {
  if (!state_.ended) end_sub_step();
  state_.ended = true;
  body_->motion.drop_next();
}

CuttableModel::Removed CuttableMotion::remove(std::span<const int> tetrahedra, const CutMesh& left) {
  end_contact();
  state_.changed = true;
  if (publisher_) publisher_->forget();
  if (body_->rest) body_->rest->look_at(body_->motion.state.u, body_->motion.state.v);
  Removed gone;
  const auto add = [&gone](const Removed& lost) {
    gone.elastic += lost.elastic;
    gone.kinetic += lost.kinetic;
    gone.momentum += lost.momentum;
  };
  for (const int t : tetrahedra) add(lost_with(t, left));
  add(body_->remove(tetrahedra, left, material_));
  show_corners(tetrahedra, left);
  std::erase_if(state_.loads, [&](const NodalLoad& load) { return !left.on_surface(load.vertex); });
  return gone;
}

void CuttableMotion::part(std::span<const Slide> slides, const Parting& parting, const CutMesh& left) {
  end_contact();
  if (publisher_) publisher_->forget();
  body_->part(slides, parting, left, material_, scaling_.frequency);
  const auto stand_anew = [&](int vertex) {
    state_.rest_places[static_cast<std::size_t>(vertex)] =
        left.mesh().vertices[static_cast<std::size_t>(vertex)];
  };
  for (const Slide& slide : slides) stand_anew(slide.vertex);
  for (const Split& split : parting.splits) stand_anew(split.copy);
  show_corners(parting.tetrahedra, left);
  for (const Split& split : parting.splits)
    state_.shown[static_cast<std::size_t>(left.number_of(split.copy))] = 1;
  take_body();
  go_on_with_body();
}

/// What is in motion is where the body says.
void CuttableMotion::go_on_with_body() noexcept {
  update_free(state_.moving);
  go_free(state_.moving);
}

}  // namespace palpate::sim
