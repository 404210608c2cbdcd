#pragma once
/// The skin of the solid: the triangles a tool can touch.
#include <array>
#include <string>
#include <vector>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// A closed triangle surface with its own vertex numbers, so that fields on it are dense arrays.
struct Surface {
  std::vector<int> vertices;        ///< (s), the mesh vertex of each surface vertex, ascending
  std::vector<Triangle> triangles;  ///< (k), indices into `vertices`; normals outward by the right-hand rule
  /// Triangles of each outer face, which follow each other: 1; where edges have a vertex in the middle 4, at
  /// the corners, each of which comes first, then between the middles.
  int per_face = 1;
};

/// The faces of a positively oriented tetrahedron by its corners, each counter-clockwise as seen from
/// outside; face k lies opposite to corner k.
constexpr std::array<Triangle, 4> kOutwardFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// (m) Across each face of each tetrahedron of a solid: the other one, or -1. O(m log m).
std::vector<std::array<int, 4>> face_neighbours(const TetMesh& mesh);

/// A face with tetrahedra in one another's place: more than two on it, or two on the same side.
struct OverlappingFace {
  Triangle vertices;            ///< ascending
  std::vector<int> tetrahedra;  ///< ascending
};
/// "the face of vertices ... belongs to ...".
std::string describe(const OverlappingFace& face);

/// The faces of a mesh that do not lie between two tetrahedra.
struct OuterFaces {
  std::vector<Triangle> triangles;        ///< on one tetrahedron; outward, by vertices of the mesh
  std::vector<OverlappingFace> overlaps;  ///< none in a solid
};

/// Finds the outer faces of a `mesh` that is positively oriented, indices in range. The order depends on the
/// mesh alone. O(m log m).
OuterFaces outer_faces(const TetMesh& mesh);

/// The faces of exactly one tetrahedron of `mesh` (as `outer_faces` needs it). Throws `Error` where faces
/// overlap. O(m log m).
Surface boundary_surface(const TetMesh& mesh);

}  // namespace palpate::sim
