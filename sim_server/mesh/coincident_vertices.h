#pragma once
/// Vertices that stand in one place, as where bodies were meshed one by one.
#include <string>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Vertices whose coordinates differ by no more than this share of the diagonal of the bounding box stand in
/// one place: two steps of a number with 24 bits, as files in single precision hold them.
constexpr double kSamePlace = 2.4e-7;

/// Outcome for vertices at the position of an earlier vertex.
struct Coincidence {
  std::size_t vertices = 0;  ///< how many
  std::string example;       ///< the first, or the one that is in the way
  std::string remedy;        ///< what to change, where they were left as they are; empty: merged
};

/// Merges the vertices of `mesh` that stand in one place, all or none; surface tags follow. It is done only
/// where it joins bodies over whole faces, which can mean one thing only. It is not where two of one place
/// are of one body (a slit, or a seam: who knows), or of one tetrahedron, or where tetrahedra would then lie
/// over each other, or bodies hang together by an edge or a vertex.
///
/// Coordinates are finite, indices in range. `sound`: no tetrahedron is flat or inverted; else nothing is
/// merged. O((n + m) log(n + m)).
Coincidence merge_coincident(TetMesh& mesh, bool sound);

/// `tetrahedra` and `surface_tags` of `mesh` by other numbers, `number[old]`, -1: in no tetrahedron any more.
/// Tags stay ascending, without repetition; one that keeps no vertex goes.
void renumber(TetMesh& mesh, const std::vector<int>& number);

/// Drops the vertices with `keep[vertex]` 0, which no tetrahedron uses, and renumbers.
void keep_vertices(TetMesh& mesh, const std::vector<char>& keep);

}  // namespace palpate::sim
