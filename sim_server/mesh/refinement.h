#pragma once
#include <functional>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// The mesh with each tetrahedron cut into eight, at the middles of its edges: its corners first, in their
/// order. The octahedron that is left inside is cut along its shortest diagonal, so that elements keep their
/// quality (Bey 1995, Computing 55:355). A middle has a surface tag where a
/// triangle with that tag has the edge, or, of a tag without triangles, where both ends have it; tagged
/// triangles are cut in four. Of a mesh without middles. O(m log m).
TetMesh refined(const TetMesh& mesh);

/// The mesh with the longest edge of each tetrahedron cut at its middle, and all tetrahedra on such edges
/// with it, the longest edge first: two to three for one, of half the length where it was largest, between a
/// mesh and `refined` (after Rivara 1984, Int. J. Numer. Meth. Engng 20:745). Its vertices come first, in
/// their order; tags as there. Of a mesh without middles. O(m log m).
TetMesh halved(const TetMesh& mesh);

/// The mesh cut like that, again and again, where an edge is longer than `longest` (m, positive) of the
/// middle of a tetrahedron, and, so that these keep their shape, around there. As `halved` otherwise.
TetMesh graded(TetMesh mesh, const std::function<double(const Vec3&)>& longest);

}  // namespace palpate::sim
