#pragma once
#include <Eigen/SparseCore>
#include <vector>

#include "sim_server/elasticity/material.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Which displacements are unknown: three per free vertex, in vertex order; a fixed vertex has none.
struct FreeDofs {
  std::vector<int> first;  ///< (n vertices) index of the x displacement, or -1 where the vertex is fixed
  int count = 0;           ///< number of unknowns

  FreeDofs(int vertices, const std::vector<int>& fixed);
};

/// Lower triangle of the linear elastic stiffness K (count x count, N/m, symmetric) over the free
/// displacements. O(tetrahedra); summed in tetrahedron order, so the same mesh gives the same bits.
SparseMatrix assemble_stiffness(const TetMesh& mesh, const Material& material, const FreeDofs& dofs);

}  // namespace palpate::sim
