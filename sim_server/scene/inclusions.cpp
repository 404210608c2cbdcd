#include "sim_server/scene/inclusions.h"

#include "common/error.h"

namespace palpate::sim {

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
