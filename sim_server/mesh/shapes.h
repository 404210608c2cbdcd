#pragma once
/// Meshes made here, for tests, benchmarks and studies.
#include <vector>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Grid lines on [-half, half], symmetric about 0: equal steps `fine` out to `core`, then steps growing by
/// `growth` (> 1), stretched together so that the last line is exactly `half`. All in m; 0 < fine, core <
/// half.
std::vector<double> graded_axis(double half, double core, double fine, double growth);

/// The block of a tensor grid (lines strictly increasing, at least two each, m): six tetrahedra a cell, all
/// sharing its main diagonal, so that neighbouring cells fit.
TetMesh grid_block(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z);

}  // namespace palpate::sim
