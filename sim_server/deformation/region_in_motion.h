#pragma once
#include <vector>

#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {

/// What of a body is in motion beside its condensed rest: what can be removed, with tetrahedra around it.
struct RegionInMotion {
  std::vector<Removable> removable;  ///< of tetrahedra
  int layers = 1;                    ///< of tetrahedra around those
  int rest_modes = 0;                ///< of the rest, that swing, at most

  /// Of each mesh vertex, 1 where it is in motion, once all may be removed of which that is said for `kNow`,
  /// or also for `kLater`.
  std::vector<char> vertices(const TetMesh& mesh, Removable until) const;
};

}  // namespace palpate::sim
