#pragma once
#include <array>

#include "common/types.h"

namespace palpate::sim {

/// The four-node tetrahedron with linear shape functions N_i.
struct LinearTetrahedron {
  double volume;                 ///< m^3, > 0 for positive orientation
  std::array<Vec3, 4> gradient;  ///< grad N_i, 1/m, constant in the element; they sum to zero

  explicit LinearTetrahedron(const std::array<Vec3, 4>& corners);
};

}  // namespace palpate::sim
