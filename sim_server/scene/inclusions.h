#pragma once
/// Parts of the tissue that are stiffer or softer than the rest: a tumour, a vessel, a scar.
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// Tells the mesh how stiff each of its tetrahedra is: those whose centroid lies in an inclusion, of several
/// the last. Nothing where the scene has none, or the mesh knows already. Throws `Error` for one without a
/// tetrahedron. O(m n).
void put_inclusions(const Scene& scene, TetMesh& mesh);

}  // namespace palpate::sim
