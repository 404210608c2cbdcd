#pragma once
/// Which tetrahedra and triangles hang together, and how.
#include <string>
#include <vector>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// (n) The body of each vertex of `mesh`, numbered from 0 in the order of their first vertices: vertices of
/// one tetrahedron are of one body. Close to O(n + m).
std::vector<int> body_of_vertices(const TetMesh& mesh);

/// The number of tetrahedra of each body, largest first.
std::vector<int> body_sizes(const TetMesh& mesh);

/// Places where a closed surface is not one sheet: edges on more than two triangles, and vertices whose
/// triangles make more than one fan around them. Sheets that join along an edge are counted there, not at its
/// ends.
struct NonManifold {
  std::size_t edges = 0, vertices = 0;
  std::array<int, 2> edge{-1, -1};  ///< the first, by vertices
  int vertex = -1;                  ///< the first
};

/// Finds such places of a closed surface: every edge on two triangles at least. O(k log k).
NonManifold non_manifold(const std::vector<Triangle>& triangles);

}  // namespace palpate::sim
