#pragma once
/// Bodies cut out of a grid.
#include <functional>
#include <vector>

#include "sim_server/mesh/shapes.h"

namespace palpate::test {

/// The tetrahedra of a grid (`grid_block`) whose middles are inside, with the vertices that they need.
inline sim::TetMesh carved(const std::vector<double>& x, const std::vector<double>& y,
                           const std::vector<double>& z, const std::function<bool(const Vec3&)>& inside) {
  const sim::TetMesh whole = sim::grid_block(x, y, z);
  sim::TetMesh mesh;
  std::vector<int> number(whole.vertices.size(), -1);
  for (sim::Tetrahedron t : whole.tetrahedra) {
    Vec3 middle = Vec3::Zero();
    for (const int v : t) middle += whole.vertices[v] / 4;
    if (!inside(middle)) continue;
    for (int& v : t) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(whole.vertices[v]);
      }
      v = number[v];
    }
    mesh.tetrahedra.push_back(t);
  }
  return mesh;
}

}  // namespace palpate::test
