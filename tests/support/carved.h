#pragma once
/// Bodies cut out of others.
#include <functional>
#include <vector>

#include "sim_server/mesh/shapes.h"

namespace palpate::test {

/// The tetrahedra that are `chosen`, by number, with the vertices that they need.
inline sim::TetMesh part_of(const sim::TetMesh& entire, const std::function<bool(int)>& chosen) {
  sim::TetMesh mesh;
  std::vector<int> number(entire.vertices.size(), -1);
  for (int t = 0; t < static_cast<int>(entire.tetrahedra.size()); ++t) {
    if (!chosen(t)) continue;
    sim::Tetrahedron corners = entire.tetrahedra[t];
    for (int& v : corners) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(entire.vertices[v]);
      }
      v = number[v];
    }
    mesh.tetrahedra.push_back(corners);
  }
  return mesh;
}

/// The tetrahedra of a grid (`grid_block`) whose middles are inside, with the vertices that they need.
inline sim::TetMesh carved(const std::vector<double>& x, const std::vector<double>& y,
                           const std::vector<double>& z, const std::function<bool(const Vec3&)>& inside) {
  const sim::TetMesh entire = sim::grid_block(x, y, z);
  return part_of(entire, [&](int t) {
    Vec3 middle = Vec3::Zero();
    for (const int v : entire.tetrahedra[t]) middle += entire.vertices[v] / 4;
    return inside(middle);
  });
}

}  // namespace palpate::test
