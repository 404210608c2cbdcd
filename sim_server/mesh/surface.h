#pragma once
/// The skin of the solid: the triangles a tool can touch.
#include <vector>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// A closed triangle surface with its own vertex numbers, so that fields on it are dense arrays.
struct Surface {
  std::vector<int> vertices;        ///< (s), the mesh vertex of each surface vertex, ascending
  std::vector<Triangle> triangles;  ///< (k), indices into `vertices`; normals outward by the right-hand rule
};

/// The faces that belong to exactly one tetrahedron of `mesh` (positively oriented, indices in range: see
/// `validate`). The order depends on the mesh alone. Throws `Error` when three or more tetrahedra share a
/// face. O(m log m).
Surface boundary_surface(const TetMesh& mesh);

}  // namespace palpate::sim
