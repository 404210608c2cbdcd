// Tissue of Implicit that is removed or separated while tools touch it.
#include <algorithm>

#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/models/implicit.h"

namespace palpate::sim {
namespace {

/// Lumped, of a node by what is left around it, kg; 0: nothing is.
double mass_at(int node, const CutMesh& remaining, double density) {
  double mass = 0;
  for (const int t : remaining.around(node)) {
    if (remaining.remains(t))
      mass += density *
              six_volumes(remaining.mesh(), remaining.mesh().tetrahedra[static_cast<std::size_t>(t)]) / 24;
  }
  return mass;
}

}  // namespace

/// Ends the step in hand: what the contact of the last step did is done first, by the tissue that bore it.
void Implicit::end_step_in_hand() {
  if (!step_.in_step) return;
  apply_new_loads();
  dynamics_.finish_step();
  step_.in_step = false;
}

std::vector<Dynamics::NodeMass> Implicit::masses_of(const std::set<int>& nodes,
                                                    const CutMesh& remaining) const {
  std::vector<Dynamics::NodeMass> masses;
  for (const int node : nodes) masses.push_back({node, mass_at(node, remaining, solid_.material().density)});
  return masses;
}

CuttableModel::Removed Implicit::remove(std::span<const int> tetrahedra, const CutMesh& remaining) {
  end_step_in_hand();
  Removed removed;
  std::set<int> touched;
  for (const int t : tetrahedra) {
    const auto e = static_cast<std::size_t>(t);
    const Tetrahedron& corners = remaining.mesh().tetrahedra[e];
    const double mass = solid_.material().density * six_volumes(remaining.mesh(), corners) / 6;
    removed.elastic += solid_.energy_of(e, dynamics_.position());
    for (const int node : corners) {
      const Vec3& v = dynamics_.velocity()[static_cast<std::size_t>(node)];
      removed.kinetic += mass / 8 * v.squaredNorm();
      removed.momentum += mass / 4 * v;
      touched.insert(node);
    }
    solid_.remove(e);
  }
  dynamics_.remove(tetrahedra, masses_of(touched, remaining));
  const auto hangs_on_nothing = [&](const VertexLoad& load) { return !remaining.on_surface(load.vertex); };
  std::erase_if(loads_, hangs_on_nothing);
  linearised_loads_ = loads_;
  return removed;
}

void Implicit::part(std::span<const Slide> slides, const Parting& parting, const CutMesh& remaining) {
  end_step_in_hand();
  std::set<int> moved, reshaped;
  const auto reshape_around = [&](int vertex) {
    for (const int t : remaining.around(vertex)) {
      if (remaining.remains(t)) reshaped.insert(t);
    }
    moved.insert(vertex);
  };
  for (const Slide& slide : slides) reshape_around(slide.vertex);
  for (const Split& split : parting.splits) reshape_around(split.copy);
  const std::vector<int> tetrahedra(reshaped.begin(), reshaped.end());
  dynamics_.note_shapes(tetrahedra);
  for (const auto& [vertex, towards, fraction] : slides) dynamics_.slide(vertex, towards, fraction);
  for (const auto& [vertex, copy] : parting.splits) {
    dynamics_.copy(vertex, copy);
    moved.insert(vertex);
  }
  solid_.reshape(remaining.mesh(), tetrahedra);
  for (const int node : moved) {
    const auto v = static_cast<std::size_t>(remaining.number_of(node));
    positions_[v] = free_[v] = dynamics_.position()[static_cast<std::size_t>(node)];
  }
  for (const int t : reshaped) {
    const Tetrahedron& corners = remaining.mesh().tetrahedra[static_cast<std::size_t>(t)];
    moved.insert(corners.begin(), corners.end());
  }
  dynamics_.part(parting.splits, masses_of(moved, remaining));
}

void Implicit::release(std::span<const std::vector<int>> floating, const CutMesh&) {
  if (solid_.material().law != ElasticLaw::kLinear) return;
  end_step_in_hand();
  solid_.release(floating);
  dynamics_.release();
}

}  // namespace palpate::sim
