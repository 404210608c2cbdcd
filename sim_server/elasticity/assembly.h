#pragma once
#include "sim_server/elasticity/material.h"
#include "sim_server/elasticity/stiffness_matrix.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Lower triangle of the linear elastic stiffness K (count x count, N/m, symmetric) over the free
/// displacements. O(tetrahedra); summed in tetrahedron order, so the same mesh gives the same bits.
SparseMatrix assemble_stiffness(const TetMesh& mesh, const Material& material, const FreeDofs& dofs);

}  // namespace palpate::sim
