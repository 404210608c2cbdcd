#include "sim_server/inclusions.h"

#include "common/error.h"
#include "sim_server/scene_parts.h"

namespace palpate::sim {

std::vector<Inclusion> read_inclusions(const Config& material) {
  std::vector<Inclusion> inclusions;
  for (const Config& section : material.tables("inclusion")) {
    Inclusion inclusion{read_region(section, "[[material.inclusion]]")};
    if (!inclusion.surface_tag.empty())
      fail("{}: `surface_tag`: an inclusion is a `box`, or `center` with `radius`", inclusion.where);
    inclusion.young_modulus = section.number("young_modulus", {1e-3, 1e12, "Pa"});
    section.reject_unknown();
    inclusions.push_back(std::move(inclusion));
  }
  return inclusions;
}

void put_inclusions(const Scene& scene, TetMesh& mesh) {
  if (scene.inclusions.empty() || !mesh.stiffness.empty()) return;
  mesh.stiffness.assign(mesh.tetrahedra.size(), 1);
  for (const Inclusion& inclusion : scene.inclusions) {
    const double ratio = inclusion.young_modulus / scene.material->young_modulus;
    bool any = false;
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
      Vec3 centroid = Vec3::Zero();
      for (const int v : mesh.tetrahedra[e]) centroid += mesh.vertices[v] / 4;
      if (!inclusion.contains(centroid)) continue;
      mesh.stiffness[e] = ratio;
      any = true;
    }
    if (!any)
      fail(
          "{}: no tetrahedron of the mesh has its centroid in this {}; is it in metres, and larger than they "
          "are?",
          inclusion.where, inclusion.box ? "box" : "ball");
  }
}

}  // namespace palpate::sim
