#include "sim_server/simulation/thin_tissue.h"

#include <algorithm>

namespace palpate::sim {
namespace {

constexpr double kOpposite = -0.5;  // cosine between the normals of two sides

/// Unit normals of the surface by vertices of the mesh; zero inside, and of held vertices.
std::vector<Vec3> free_normals(const TetMesh& mesh, const Surface& surface, const std::vector<int>& held) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const Triangle& t : surface.triangles) {
    const auto at = [&](int k) { return mesh.vertices[surface.vertices[t[k]]]; };
    const Vec3 area = (at(1) - at(0)).cross(at(2) - at(0));
    for (const int k : t) normals[surface.vertices[k]] += area;
  }
  for (const int vertex : held) normals[vertex].setZero();
  for (Vec3& normal : normals) normal.normalize();
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
    : thin_(surface.vertices.size(), 0) {
  const std::vector<Vec3> normals = free_normals(mesh, surface, held);
  const std::vector<std::vector<int>> neighbours = neighbours_of(mesh);
  std::vector<int> near, next;
  for (std::size_t k = 0; k < surface.vertices.size(); ++k) {
    const int vertex = surface.vertices[k];
    near = {vertex};
    for (int layer = 1; layer < kLayers && thin_[k] == 0; ++layer) {
      next.clear();
      for (const int v : near) next.insert(next.end(), neighbours[v].begin(), neighbours[v].end());
      const bool other_side =
          std::ranges::any_of(next, [&](int v) { return normals[v].dot(normals[vertex]) < kOpposite; });
      thin_[k] = other_side ? 1 : 0;
      near.swap(next);
    }
  }
}

bool ThinTissue::bears(std::span<const VertexLoad> loads) const noexcept {
  double all = 0, thin = 0;
  for (const VertexLoad& load : loads) {
    const double size = load.force.norm();
    all += size;
    thin += static_cast<std::size_t>(load.vertex) < thin_.size() && thin_[load.vertex] != 0 ? size : 0;
  }
  return all > 0 && 2 * thin >= all;
}

}  // namespace palpate::sim
