#include "sim_server/mesh/tet_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim_server/mesh/surface.h"

namespace palpate::sim {
namespace {

// The six edges of a tetrahedron, each followed by the two corners it does not touch.
constexpr std::array<std::array<int, 4>, 6> kDihedrals{
    {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};

// The angle between the two faces that meet at edge (a, b), seen from inside; c and d are the other corners.
double dihedral(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 m = (b - a).cross(c - a), n = (b - a).cross(d - a);
  return std::atan2(m.cross(n).norm(), m.dot(n));
}

std::array<double, 6> dihedrals(const TetMesh& mesh, const Tetrahedron& t) {
  const std::vector<Vec3>& x = mesh.vertices;
  std::array<double, 6> angles{};
  std::ranges::transform(kDihedrals, angles.begin(), [&](const std::array<int, 4>& e) {
    return dihedral(x[t[e[0]]], x[t[e[1]]], x[t[e[2]]], x[t[e[3]]]);
  });
  return angles;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Both corners ascending, and all of them.
std::vector<std::array<int, 2>> edges_of(const TetMesh& mesh) {
  std::vector<std::array<int, 2>> edges;
  edges.reserve(6 * mesh.tetrahedra.size());
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const auto& [i, j] : kEdges) edges.push_back({std::min(t[i], t[j]), std::max(t[i], t[j])});
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  edges.shrink_to_fit();
  return edges;
}

void describe_edges(const TetMesh& mesh, MeshInfo& info) {
  const auto edges = edges_of(mesh);
  std::vector<double> lengths;
  lengths.reserve(edges.size());
  for (const auto& [a, b] : edges) lengths.push_back((mesh.vertices[a] - mesh.vertices[b]).norm());
  info.edges = static_cast<int>(edges.size());
  info.min_edge = *std::ranges::min_element(lengths);
  info.max_edge = *std::ranges::max_element(lengths);
  info.median_edge = median(std::move(lengths));
}

void describe_tetrahedra(const TetMesh& mesh, MeshInfo& info) {
  std::vector<double> smallest;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    const auto angles = dihedrals(mesh, t);
    const auto [least, most] = std::minmax_element(angles.begin(), angles.end());
    smallest.push_back(*least);
    info.max_dihedral = std::max(info.max_dihedral, *most);
    info.volume += six_volumes(mesh, t) / 6;
  }
  info.min_dihedral = *std::ranges::min_element(smallest);
  info.median_min_dihedral = median(std::move(smallest));
}

}  // namespace

int TetMesh::middle(int a, int b) const {
  const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
  return corners() + static_cast<int>(std::ranges::lower_bound(mid_edges, edge) - mid_edges.begin());
}

void add_mid_edges(TetMesh& mesh) {
  if (!mesh.mid_edges.empty()) return;
  std::vector<std::array<int, 2>> edges = edges_of(mesh);
  mesh.vertices.reserve(mesh.vertices.size() + edges.size());
  for (const auto& [a, b] : edges) mesh.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
  mesh.mid_edges = std::move(edges);
}

void sort_tags(TetMesh& mesh) {
  const auto put_in_order = [](auto& list, const auto& is_removed) {
    std::erase_if(list, is_removed);
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  for (auto& [name, vertices] : mesh.surface_tags) put_in_order(vertices, [](int v) { return v < 0; });
  for (auto& [name, triangles] : mesh.tagged_triangles) {
    for (Triangle& t : triangles) std::ranges::sort(t);
    put_in_order(triangles, [](const Triangle& t) { return t[0] < 0; });
  }
  std::erase_if(mesh.surface_tags, [](const auto& tag) { return tag.second.empty(); });
  std::erase_if(mesh.tagged_triangles, [](const auto& tag) { return tag.second.empty(); });
}

Vec3 centre_of(const TetMesh& mesh, const Tetrahedron& t) {
  Vec3 centre = Vec3::Zero();
  for (const int v : t) centre += mesh.vertices[static_cast<std::size_t>(v)] / 4;
  return centre;
}

double six_volumes(const TetMesh& mesh, const Tetrahedron& t) {
  const std::vector<Vec3>& x = mesh.vertices;
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).dot(x[t[3]] - x[t[0]]);
}

double smallest_dihedral(const TetMesh& mesh, const Tetrahedron& t) {
  const auto angles = dihedrals(mesh, t);
  return *std::ranges::min_element(angles);
}

double shortest_height(const TetMesh& mesh, const Tetrahedron& t) {
  double largest = 0;  // twice the area of a face
  for (int i = 0; i < 4; ++i) {
    const Vec3 &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 4]],
               &c = mesh.vertices[t[(i + 2) % 4]];
    largest = std::max(largest, (b - a).cross(c - a).norm());
  }
  return std::abs(six_volumes(mesh, t)) / largest;
}

MeshInfo describe(const TetMesh& mesh) {
  MeshInfo info;
  if (mesh.tetrahedra.empty()) return info;
  const Surface surface = boundary_surface(mesh);
  info.vertices = mesh.corners();
  info.tetrahedra = static_cast<int>(mesh.tetrahedra.size());
  const auto& skin = surface.vertices;  // ascending: corners first
  info.boundary_vertices = static_cast<int>(std::ranges::lower_bound(skin, mesh.corners()) - skin.begin());
  info.boundary_triangles = static_cast<int>(surface.triangles.size()) / surface.per_face;
  info.min = info.max = mesh.vertices.front();
  for (const Vec3& x : mesh.vertices) {
    info.min = info.min.cwiseMin(x);
    info.max = info.max.cwiseMax(x);
  }
  describe_edges(mesh, info);
  describe_tetrahedra(mesh, info);
  return info;
}

}  // namespace palpate::sim
