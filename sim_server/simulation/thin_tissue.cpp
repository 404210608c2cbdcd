#include "sim_server/simulation/thin_tissue.h"

#include <algorithm>

namespace palpate::sim {
namespace {

constexpr double kOpposite = -0.5;  // cosine between the normals of two sides, and of a load that presses one

using Normals = std::vector<std::vector<Vec3>>;

/// Unit normals of the faces at each vertex of the mesh; none inside, nor of held vertices.
Normals free_normals(const TetMesh& mesh, const Surface& surface, const std::vector<int>& held) {
  Normals normals(mesh.vertices.size());
  for (const Triangle& t : surface.triangles) {
    const auto at = [&](int k) { return mesh.vertices[surface.vertices[t[k]]]; };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const int k : t) normals[surface.vertices[k]].push_back(normal);
  }
  for (const int vertex : held) normals[vertex].clear();
  return normals;
}

std::vector<std::vector<int>> neighbours_of(const TetMesh& mesh) {
  std::vector<std::vector<int>> neighbours(mesh.vertices.size());
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const auto& [a, b] : kEdges) {
      neighbours[t[a]].push_back(t[b]);
      neighbours[t[b]].push_back(t[a]);
    }
  }
  for (std::vector<int>& some : neighbours) {
    std::ranges::sort(some);
    some.erase(std::ranges::unique(some).begin(), some.end());
  }
  return neighbours;
}

}  // namespace

ThinTissue::ThinTissue(const TetMesh& mesh, const Surface& surface, const std::vector<int>& held)
    : thin_(surface.vertices.size()) {
  const Normals normals = free_normals(mesh, surface, held);
  const std::vector<std::vector<int>> neighbours = neighbours_of(mesh);
  std::vector<int> near, next;
  for (std::size_t k = 0; k < surface.vertices.size(); ++k) {
    near = {surface.vertices[k]};
    for (int layer = 1; layer < kLayers; ++layer) {
      next = near;
      for (const int v : near) next.insert(next.end(), neighbours[v].begin(), neighbours[v].end());
      near.swap(next);
    }
    std::ranges::copy_if(normals[surface.vertices[k]], std::back_inserter(thin_[k]), [&](const Vec3& normal) {
      return std::ranges::any_of(near, [&](int v) {
        return std::ranges::any_of(normals[v], [&](const Vec3& n) { return n.dot(normal) < kOpposite; });
      });
    });
  }
}

bool ThinTissue::bears(std::span<const VertexLoad> loads) const noexcept {
  double all = 0, thin = 0;
  for (const VertexLoad& load : loads) {
    const double size = load.force.norm();
    all += size;
    if (static_cast<std::size_t>(load.vertex) >= thin_.size()) continue;  // of a cut
    const bool bends = std::ranges::any_of(
        thin_[load.vertex], [&](const Vec3& normal) { return load.force.dot(normal) < kOpposite * size; });
    thin += bends ? size : 0;
  }
  return all > 0 && 2 * thin >= all;
}

}  // namespace palpate::sim
