#include "sim_server/simulation/set_up_memory.h"

#include <fmt/core.h>

#include "sim_server/models/deformation_models.h"

namespace palpate::sim {

void require_memory_for(const Scene& scene, Purpose purpose, const MeshCounts& counts, double free) {
  if (!scene.material) return;  // the model asks for one, where it needs it
  const ElementKind element = scene.material->element;
  double bytes = purpose == Purpose::kSolve ? body_bytes(counts, element, 2)  // of now, and at rest
                                            : model_of(scene.deformation).estimated_bytes(scene, counts);
  if (!scene.inclusions.empty())
    bytes += 2 * counts.tetrahedra * sizeof(double);  // in the mesh and in its solid
  require_memory(bytes, free, scene.source,
                 fmt::format("the stiffness of {:.0f} tetrahedra", counts.tetrahedra),
                 element == ElementKind::kQuadratic ? "take a coarser mesh, or another `element`"
                                                    : "take a coarser mesh");
}

}  // namespace palpate::sim
