#include "sim_server/scene/cutting.h"

#include <algorithm>

#include "common/error.h"

namespace palpate::sim {
namespace {

/// Of each tetrahedron, whether its centre is in a region, or of a surface tag any of its vertices on it.
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

std::vector<Removable> removable_tetrahedra(const Cutting& cutting, const TetMesh& mesh) {
  const std::size_t count = mesh.tetrahedra.size();
  const std::vector<char> all(count, 1);
  const std::vector<char> now = cutting.region ? in_region(*cutting.region, mesh) : all;
  std::vector<char> later(count, 0);
  if (cutting.growth) later = cutting.growth->region ? in_region(*cutting.growth->region, mesh) : all;
  const auto is_near = [&](const Tetrahedron& t) {
    return !cutting.plan || !cutting.plan->within ||
           std::abs(cutting.plan->distance(centre_of(mesh, t))) <= *cutting.plan->within;
  };
  std::vector<Removable> removable;
  for (std::size_t t = 0; t < count; ++t) {
    const bool can = now[t] != 0 && is_near(mesh.tetrahedra[t]);
    removable.push_back(can ? Removable::kNow : later[t] != 0 ? Removable::kLater : Removable::kNever);
  }
  if (std::ranges::count(removable, Removable::kNow) == 0)
    fail("{}: no tetrahedron of the mesh lies in what can be cut; make the region, or `within`, larger",
         cutting.where);
  return removable;
}

}  // namespace palpate::sim
