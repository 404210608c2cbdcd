#pragma once
/// What is left of a body that was cut, and whether its surface is closed.
#include <algorithm>
#include <map>
#include <vector>

#include "sim_server/mesh/cut_mesh.h"

namespace palpate::test {

/// What is left, as a mesh of its own with the same vertices.
inline sim::TetMesh rest_of(const sim::TetMesh& mesh, const sim::CutMesh& cut) {
  sim::TetMesh rest = mesh;
  rest.tetrahedra.clear();
  for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) {
    if (cut.remains(t)) rest.tetrahedra.push_back(mesh.tetrahedra[static_cast<std::size_t>(t)]);
  }
  return rest;
}

/// The triangles of a surface by the vertices of its mesh.
inline std::vector<sim::Triangle> by_mesh_vertices(const sim::Surface& surface) {
  std::vector<sim::Triangle> triangles = surface.triangles;
  for (sim::Triangle& t : triangles) {
    for (int& v : t) v = surface.vertices[static_cast<std::size_t>(v)];
  }
  return triangles;
}

/// Each with its smallest corner first, as it is oriented; ascending.
inline std::vector<sim::Triangle> in_order(std::vector<sim::Triangle> triangles) {
  for (sim::Triangle& t : triangles) std::rotate(t.begin(), std::ranges::min_element(t), t.end());
  std::ranges::sort(triangles);
  return triangles;
}

/// How many edges have more triangles that go along them one way than the other: none where they close.
inline std::ptrdiff_t open_edges(const std::vector<sim::Triangle>& triangles) {
  std::map<std::pair<int, int>, int> along;
  for (const sim::Triangle& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      along[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return std::ranges::count_if(along, [](const auto& edge) { return edge.second != 0; });
}

}  // namespace palpate::test
