#include "sim_server/mesh/connectivity.h"

#include <algorithm>
#include <functional>
#include <tuple>

#include "sim_server/mesh/disjoint_sets.h"

namespace palpate::sim {
namespace {

/// An edge of a triangle; the corners (3 x triangle + corner) that stand at its ends.
struct Side {
  int low, high;  // vertices
  int at_low, at_high;
};

std::vector<Side> sorted_sides(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, a = triangles[t][i], b = triangles[t][j];
      const int at_a = static_cast<int>(3 * t) + i, at_b = static_cast<int>(3 * t) + j;
      sides.push_back(a < b ? Side{a, b, at_a, at_b} : Side{b, a, at_b, at_a});
    }
  }
  std::ranges::sort(sides, [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.at_low) < std::tie(b.low, b.high, b.at_low);
  });
  return sides;
}

}  // namespace

std::vector<int> body_of_vertices(const TetMesh& mesh) {
  DisjointSets sets(mesh.vertices.size());
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const int vertex : t) sets.join(vertex, t[0]);
  }
  return sets.numbers();
}

std::vector<int> body_sizes(const TetMesh& mesh) {
  const std::vector<int> body = body_of_vertices(mesh);
  std::vector<int> size(mesh.vertices.size(), 0);
  for (const Tetrahedron& t : mesh.tetrahedra) ++size[body[t[0]]];
  std::ranges::sort(size, std::greater<>());
  size.erase(std::ranges::find(size, 0), size.end());
  return size;
}

NonManifold non_manifold(const std::vector<Triangle>& triangles) {
  NonManifold found;
  const std::vector<Side> sides = sorted_sides(triangles);
  DisjointSets fans(3 * triangles.size());  // of corners
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const Side& side) {
      return side.low != first->low || side.high != first->high;
    });
    for (auto side = first; side != last; ++side) {
      fans.join(side->at_low, first->at_low);
      fans.join(side->at_high, first->at_high);
    }
    if (last - first > 2 && ++found.edges == 1) found.edge = {first->low, first->high};
    first = last;
  }
  std::vector<std::pair<int, int>> fan_at;  // vertex, fan
  for (int corner = 0; corner < static_cast<int>(3 * triangles.size()); ++corner)
    fan_at.emplace_back(triangles[corner / 3][corner % 3], fans.of(corner));
  std::ranges::sort(fan_at);
  fan_at.erase(std::unique(fan_at.begin(), fan_at.end()), fan_at.end());
  int counted = -1;
  for (std::size_t i = 1; i < fan_at.size(); ++i) {
    const int vertex = fan_at[i].first;
    if (vertex != fan_at[i - 1].first || vertex == counted) continue;
    counted = vertex;
    if (++found.vertices == 1) found.vertex = vertex;
  }
  return found;
}

}  // namespace palpate::sim
