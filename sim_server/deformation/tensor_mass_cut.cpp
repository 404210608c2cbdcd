// Tissue of TensorMass that is removed while it is felt.
#include <algorithm>

#include "sim_server/deformation/tensor_mass.h"
#include "sim_server/elasticity/element.h"
#include "sim_server/elasticity/laws.h"
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

/// What the contact of the last period did is done first, by the tissue that bore it.
DeformationModel::Removed TensorMass::remove(std::span<const int> tetrahedra, const CutMesh& left) {
  if (!ended_) end_period();
  ended_ = true;
  Removed gone;
  const auto motion_of = [&](const std::vector<double>& numbers, int vertex) -> Vec3 {
    const int place = tensors_.places()[static_cast<std::size_t>(vertex)];
    return place < 0 ? Vec3(Vec3::Zero()) : Vec3(Eigen::Map<const Vec3>(numbers.data() + 3 * place));
  };
  for (const int t : tetrahedra) {
    const Tetrahedron& corners = left.mesh().tetrahedra[static_cast<std::size_t>(t)];
    std::array<Vec3, 4> x, u;
    const double mass = cut_material_->density * six_volumes(left.mesh(), corners) / 6;
    for (std::size_t i = 0; i < 4; ++i) {
      x[i] = mesh_rest_[static_cast<std::size_t>(corners[i])];
      u[i] = motion_of(state().u, corners[i]);
      const Vec3 v = motion_of(state().v, corners[i]);
      gone.kinetic += mass / 8 * v.squaredNorm();
      gone.momentum += mass / 4 * v;
    }
    const double stiffness =
        left.mesh().stiffness.empty() ? 1 : left.mesh().stiffness[static_cast<std::size_t>(t)];
    gone.elastic += stiffness * linear_energy(LinearTetrahedron(x), u, *cut_material_);
  }
  tensors_.remove(tetrahedra, left, *cut_material_);
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

}  // namespace palpate::sim
