#pragma once
/// Faults of a user's mesh, reported all at once, and their repair.
#include <string>
#include <vector>

#include "common/units.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Outcome of a fault: mended, harmless, or to be corrected by the author of the mesh.
enum class Cure { kMended, kAccepted, kRefused };

/// Faults of one kind.
struct MeshFault {
  Cure cure;
  std::size_t count;
  std::string kind;     ///< "unused vertices"
  std::string example;  ///< a sentence about the first; numbers count from 0 in the mesh as it was mended
  std::string remedy;   ///< what was done, or what to change; empty: nothing need be
};

struct MeshFaults {
  std::vector<MeshFault> found;
  bool surface_seen = true;  ///< else flat tetrahedra and the like hid what is wrong with the surface

  bool refused() const;
};

/// Mends `mesh` where that can mean one thing only, and tells everything that was wrong:
/// - mended: vertices in no tetrahedron and repeated tetrahedra (dropped), vertices in one place (merged,
///   where `merge_coincident` can), tetrahedra that are all inverted (turned round);
/// - refused: no tetrahedra, vertices that are not there, coordinates that are not finite, a vertex twice in
/// a
///   tetrahedron, flat or inverted tetrahedra, other vertices in one place, several bodies, tetrahedra that
///   overlap at a face;
/// - accepted: edges and vertices where the surface meets itself, hinges, slivers.
/// Surface tags follow. Without faults, tetrahedra are positively oriented and the surface is closed.
/// O((n + m) log(n + m)).
MeshFaults mend(TetMesh& mesh);

/// Throws `Error` naming `source` about the first fault that is refused, if there is one.
void require_usable(const MeshFaults& faults, const std::string& source);

/// A tetrahedron of a smaller dihedral angle is a sliver: its heights are about 1/40 of a good one's, as
/// sin(1 degree) to sin(45). Meshes that were optimised, surface and all, have no such angle (those of Gmsh
/// that were tried: above 11 degrees).
constexpr double kSliver = kDegree;

/// A sentence that names the likely unit, where a mesh in metres is longer than 5 m or shorter than 5 mm;
/// else empty.
std::string odd_size(const TetMesh& mesh);

/// The sentence about slivers, with what they do and what to do; empty where there are none.
std::string slivers_in_short(const MeshFaults& faults);

/// "unused vertices (2) dropped, repeated tetrahedra (1) dropped"; empty where nothing was mended.
std::string mended_in_short(const MeshFaults& faults);

}  // namespace palpate::sim
