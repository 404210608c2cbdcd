#pragma once
/// Parts of a mesh that could still move when some vertices are held.
#include <array>
#include <span>
#include <string>
#include <vector>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Tetrahedra that hang together by whole faces, and are held by too little.
struct LoosePart {
  std::size_t tetrahedra = 0;
  /// Support of the part: nothing, one place (it can turn about it), or places in one line (a hinge).
  enum class Hold { kNone, kPlace, kLine };
  Hold hold = Hold::kNone;
  Vec3 place = Vec3::Zero();  ///< the first of them, m; of a part that nothing holds: one of its vertices
};

/// Finds the parts of `mesh` that are loose when `held` (vertices) are fixed, largest first. A part is held
/// by fixed vertices, and by its common vertices with a held part, where three of them are not in one line.
/// Parts joined in an edge or a vertex only have a hinge between them. O(m log m).
std::vector<LoosePart> loose_parts(const TetMesh& mesh, std::span<const int> held);

/// Takes the tetrahedra of such parts out of `mesh`; its vertices stay. O(m log m).
void drop_loose_parts(TetMesh& mesh, std::span<const int> held);

/// "3 tetrahedra hang on a hinge at 0.1,0,0".
std::string to_text(const LoosePart& part);

/// Two parts that meet in vertices of one line only: about it one can turn against the other.
struct Hinge {
  std::array<std::size_t, 2> tetrahedra;  ///< how many each part has
  std::vector<int> vertices;              ///< which both have, ascending
};

/// Finds the places where parts of one body are joined in an edge, a vertex, or several in one line only.
/// Parts are tetrahedra that hang together by faces, and others with three common vertices not in one line.
/// O(m log m) where parts are few.
std::vector<Hinge> hinges(const TetMesh& mesh);

}  // namespace palpate::sim
