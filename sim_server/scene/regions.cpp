#include "sim_server/scene/regions.h"

#include <Eigen/Geometry>

#include "common/error.h"
#include "common/text.h"
#include "sim_server/mesh/bounding_box.h"

namespace palpate::sim {

std::vector<int> vertices_in(const Region& region, const TetMesh& mesh) {
  if (!region.surface_tag.empty()) {
    std::vector<std::string> known;
    for (const auto& [tag, vertices] : mesh.surface_tags) known.push_back(tag);
    if (known.empty())
      fail(
          "{}: `surface_tag`: the mesh names no part of its surface; take a `box`, or `center` with `radius`",
          region.where);
    const auto found = mesh.surface_tags.find(region.surface_tag);
    if (found == mesh.surface_tags.end())
      fail_unknown_name(region.surface_tag, "surface tag", region.where, known);
    return found->second;
  }
  std::vector<int> inside;
  for (int v = 0; v < mesh.corners(); ++v) {
    if (region.contains(mesh.vertices[v])) inside.push_back(v);
  }
  if (inside.empty()) {
    const Eigen::AlignedBox3d box = bounding_box(mesh.vertices);
    fail(
        "{}: no vertex of the mesh lies in this {}; is it in metres? The mesh is from {:.4g},{:.4g},{:.4g} "
        "to "
        "{:.4g},{:.4g},{:.4g}",
        region.where, region.box ? "box" : "ball", box.min()[0], box.min()[1], box.min()[2], box.max()[0],
        box.max()[1], box.max()[2]);
  }
  return inside;
}

}  // namespace palpate::sim
