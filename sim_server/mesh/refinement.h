#pragma once
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// The mesh with each tetrahedron cut into eight, at the middles of its edges: its corners first, in their
/// order. The octahedron that is left inside is cut along its shortest diagonal, so that elements keep their
/// quality (Bey 1995, Computing 55:355). A middle has a surface tag where both ends have it;
/// tagged triangles are cut in four. Of a mesh
/// without middles. O(m log m).
TetMesh refined(const TetMesh& mesh);

}  // namespace palpate::sim
