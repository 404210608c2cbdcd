#pragma once
#include <vector>

#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {

/// What of a body is in motion beside its condensed rest: what can be removed, with tetrahedra around it.
struct RegionInMotion {
  std::vector<char> removable;  ///< of tetrahedra, 1 or 0
  int layers = 1;               ///< of tetrahedra around those
  int rest_modes = 0;           ///< of the rest, that swing, at most

  /// Returns 1 for each mesh vertex that is in motion, else 0.
  std::vector<char> vertices(const TetMesh& mesh) const;
};

}  // namespace palpate::sim
