#include "sim_server/scene/cutting.h"

#include <algorithm>

#include "common/error.h"

namespace palpate::sim {

std::vector<char> removable_tetrahedra(const Cutting& cutting, const TetMesh& mesh) {
  std::vector<int> tagged;
  const bool by_tag = cutting.region && !cutting.region->surface_tag.empty();
  if (by_tag) tagged = vertices_in(*cutting.region, mesh);
  std::vector<char> removable;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    Vec3 centre = Vec3::Zero();
    bool on_tag = false;
    for (const int v : t) {
      centre += mesh.vertices[static_cast<std::size_t>(v)] / 4;
      on_tag = on_tag || std::ranges::binary_search(tagged, v);
    }
    bool can = !cutting.region || (by_tag ? on_tag : cutting.region->contains(centre));
    if (cutting.plan && cutting.plan->within)
      can = can && std::abs(cutting.plan->distance(centre)) <= *cutting.plan->within;
    removable.push_back(can ? 1 : 0);
  }
  if (std::ranges::count(removable, 1) == 0)
    fail("{}: no tetrahedron of the mesh lies in what can be cut; make the region, or `within`, larger",
         cutting.where);
  return removable;
}

}  // namespace palpate::sim
