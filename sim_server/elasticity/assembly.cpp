#include "sim_server/elasticity/assembly.h"

#include "sim_server/elasticity/element.h"

namespace palpate::sim {

SparseMatrix assemble_stiffness(const TetMesh& mesh, const Material& material, const FreeDofs& dofs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(mesh.tetrahedra.size() * (4 * 6 + 6 * 9));
  const auto add = [&](int row, int column, const Mat3& block) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        if (row + r >= column + c) entries.emplace_back(row + r, column + c, block(r, c));
      }
    }
  };
  for (const Tetrahedron& t : mesh.tetrahedra) {
    const LinearTetrahedron element(
        {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], mesh.vertices[t[3]]});
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const int row = dofs.first[t[i]], column = dofs.first[t[j]];
        if (row < 0 || column < 0 || row < column) continue;
        add(row, column, element.stiffness_block(i, j, material));
      }
    }
  }
  SparseMatrix stiffness(dofs.count, dofs.count);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  return stiffness;
}

}  // namespace palpate::sim
