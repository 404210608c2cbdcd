#pragma once
#include <vector>

#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {

/// Part of a body that is in motion beside its condensed part: the removable tetrahedra, with layers around
/// them.
struct RegionInMotion {
  std::vector<char> removable;  ///< of tetrahedra, 1 or 0
  int layers = 1;               ///< of tetrahedra around those
  int condensed_modes = 0;      ///< of the rest, that swing, at most

  /// Returns 1 for each mesh vertex that is in motion, else 0.
  std::vector<char> vertices(const TetMesh& mesh) const;
};

}  // namespace palpate::sim
