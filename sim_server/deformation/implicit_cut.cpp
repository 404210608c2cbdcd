// Tissue of Implicit that is removed while it is felt.
#include <algorithm>

#include "sim_server/deformation/implicit.h"
#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {
namespace {

/// Lumped, of a node by what is left around it, kg; 0: nothing is.
double mass_at(int node, const CutMesh& left, double density) {
  double mass = 0;
  for (const int t : left.around(node)) {
    if (left.is_left(t))
      mass += density * six_volumes(left.mesh(), left.mesh().tetrahedra[static_cast<std::size_t>(t)]) / 24;
  }
  return mass;
}

}  // namespace

/// What the contact of the last step did is done first, by the tissue that bore it.
DeformationModel::Removed Implicit::remove(std::span<const int> tetrahedra, const CutMesh& left) {
  if (in_step_) {
    apply_new_loads();
    dynamics_.finish_step();
    in_step_ = false;
  }
  Removed gone;
  std::vector<int> touched;
  for (const int t : tetrahedra) {
    const auto e = static_cast<std::size_t>(t);
    const Tetrahedron& corners = left.mesh().tetrahedra[e];
    const double mass = solid_.material().density * six_volumes(left.mesh(), corners) / 6;
    gone.elastic += solid_.energy_of(e, dynamics_.position());
    for (const int node : corners) {
      const Vec3& v = dynamics_.velocity()[static_cast<std::size_t>(node)];
      gone.kinetic += mass / 8 * v.squaredNorm();
      gone.momentum += mass / 4 * v;
      touched.push_back(node);
    }
    solid_.remove(e);
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  std::vector<Dynamics::NodeMass> masses;
  for (const int node : touched) {
    masses.push_back({node, mass_at(node, left, solid_.material().density)});
  }
  dynamics_.remove(tetrahedra, masses);
  const auto hangs_on_nothing = [&](const NodalLoad& load) { return !left.on_surface(load.vertex); };
  std::erase_if(loads_, hangs_on_nothing);
  linearised_loads_ = loads_;
  return gone;
}

}  // namespace palpate::sim
