#include "sim_server/scene/cutting.h"

#include <algorithm>

#include "common/error.h"

namespace palpate::sim {
namespace {

/// Returns, of each tetrahedron, whether its centre is in a region, or of a surface tag any of its vertices
/// on it.
std::vector<char> in_region(const Region& region, const TetMesh& mesh) {
  std::vector<int> tagged;
  const bool by_tag = !region.surface_tag.empty();
  if (by_tag) tagged = vertices_in(region, mesh);
  const auto is_tagged = [&](int v) { return std::ranges::binary_search(tagged, v); };
  std::vector<char> in;
  for (const Tetrahedron& t : mesh.tetrahedra)
    in.push_back(by_tag ? std::ranges::any_of(t, is_tagged) : region.contains(centre_of(mesh, t)));
  return in;
}

}  // namespace

std::vector<char> removable_tetrahedra(const Cutting& cutting, const TetMesh& mesh) {
  std::vector<char> removable(mesh.tetrahedra.size(), 1);
  if (cutting.region) removable = in_region(*cutting.region, mesh);
  for (std::size_t t = 0; t < removable.size() && cutting.plan && cutting.plan->within; ++t) {
    if (!(std::abs(cutting.plan->distance(centre_of(mesh, mesh.tetrahedra[t]))) <= *cutting.plan->within))
      removable[t] = 0;
  }
  if (std::ranges::count(removable, 1) == 0)
    fail("{}: no tetrahedron of the mesh lies in what can be cut; make the region, or `within`, larger",
         cutting.where);
  return removable;
}

}  // namespace palpate::sim
