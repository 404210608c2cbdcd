#pragma once
#include <array>

#include "common/types.h"
#include "sim_server/elasticity/material.h"

namespace palpate::sim {

/// The four-node tetrahedron with linear shape functions N_i.
struct LinearTetrahedron {
  double volume;                 ///< m^3, > 0 for positive orientation
  std::array<Vec3, 4> gradient;  ///< grad N_i, 1/m, constant in the element; they sum to zero

  explicit LinearTetrahedron(const std::array<Vec3, 4>& corners);

  /// The (3 x 3) block K_ij (N/m) of the small-strain stiffness: force on node i per displacement of node j
  /// is K_ij,
  ///   K_ij = V (lambda g_i g_j^T + mu g_j g_i^T + mu (g_i . g_j) I),  g = gradient
  /// (Cotin, Delingette and Ayache 2000, Vis. Comput. 16:437, eq. 12: their vertex and edge tensors). K_ji =
  /// K_ij^T.
  Mat3 stiffness_block(int i, int j, const Material& material) const;
};

}  // namespace palpate::sim
