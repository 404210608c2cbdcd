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
    some.erase(std::unique(some.begin(), some.end()), some.end());
  }
  return neighbours;
}

/// The longest edge of the surface at each of its vertices, m.
std::vector<double> longest_edges(const TetMesh& mesh, const Surface& surface) {
  std::vector<double> longest(surface.vertices.size(), 0);
  const auto at = [&](int v) -> const Vec3& { return mesh.vertices[surface.vertices[v]]; };
  for (const Triangle& t : surface.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      const double length = (at(a) - at(b)).norm();
      longest[a] = std::max(longest[a], length);
      longest[b] = std::max(longest[b], length);
    }
  }
  return longest;
}

/// Finds the vertices of a mesh near one of them, by its edges.
class Nearby {
 public:
  explicit Nearby(const TetMesh& mesh)
      : mesh_(mesh), neighbours_(neighbours_of(mesh)), seen_(mesh.vertices.size(), -1) {}

  /// Those within `reach` (m) that edges within it lead to, and `from` itself. Valid until the next call.
  std::span<int> within(double reach, int from) {
    found_ = {from};
    seen_[from] = from;
    for (std::size_t k = 0; k < found_.size(); ++k) {
      for (const int next : neighbours_[found_[k]]) {
        if (seen_[next] == from || (mesh_.vertices[next] - mesh_.vertices[from]).norm() > reach) continue;
        seen_[next] = from;
        found_.push_back(next);
      }
    }
    return found_;
  }

 private:
  const TetMesh& mesh_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<int> seen_;  // from which vertex each was last found
  std::vector<int> found_;
};

/// True if some face at these vertices looks the other way.
bool is_opposed(const Vec3& normal, std::span<const int> near, const Normals& normals) {
  return std::ranges::any_of(near, [&](int v) {
    return std::ranges::any_of(normals[v], [&](const Vec3& n) { return n.dot(normal) < kOpposite; });
  });
}

/// True if faces at these vertices look both ways across a normal, too.
bool is_bar(const Vec3& normal, std::span<const int> near, const Normals& normals) {
  for (const int v : near) {
    for (const Vec3& n : normals[v]) {
      if (std::abs(n.dot(normal)) < -kOpposite && is_opposed(n, near, normals)) return true;
    }
  }
  return false;
}

}  // namespace

ThinTissue::ThinTissue(const TetMesh& mesh, const Surface& surface, const std::vector<int>& held)
    : thin_(surface.vertices.size()) {
  const Normals normals = free_normals(mesh, surface, held);
  const std::vector<double> edges = longest_edges(mesh, surface);
  Nearby nearby(mesh);
  for (std::size_t k = 0; k < surface.vertices.size(); ++k) {
    const int vertex = surface.vertices[k];
    const std::span<int> near = nearby.within(kEdgesOfBar * edges[k], vertex);
    const auto is_nearest = [&](int v) {
      return (mesh.vertices[v] - mesh.vertices[vertex]).norm() <= kEdges * edges[k];
    };
    const auto nearest =
        static_cast<std::size_t>(std::partition(near.begin(), near.end(), is_nearest) - near.begin());
    std::ranges::copy_if(normals[vertex], std::back_inserter(thin_[k]), [&](const Vec3& normal) {
      return is_opposed(normal, near.first(nearest), normals) ||
             (is_opposed(normal, near, normals) && is_bar(normal, near, normals));
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

std::size_t ThinTissue::bytes() const noexcept {
  std::size_t sum = thin_.size() * sizeof(thin_[0]);
  for (const std::vector<Vec3>& normals : thin_) sum += normals.size() * sizeof(Vec3);
  return sum;
}

}  // namespace palpate::sim
