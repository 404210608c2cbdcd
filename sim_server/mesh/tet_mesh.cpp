#include "sim_server/mesh/tet_mesh.h"

#include <algorithm>
#include <cmath>
#include <fmt/ranges.h>
#include <functional>
#include <numeric>
#include <utility>

#include "common/error.h"
#include "sim_server/mesh/surface.h"

namespace palpate::sim {
namespace {

// The six edges of a tetrahedron, each followed by the two corners it does not touch.
constexpr std::array<std::array<int, 4>, 6> kEdges{
    {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};

// |6V| of a flat tetrahedron, relative to the cube of its longest edge: rounding leaves about 1e-16.
constexpr double kFlat = 1e-12;

std::string text(const Vec3& x) {
  return fmt::format("({:g}, {:g}, {:g})", x[0], x[1], x[2]);
}

double longest_edge(const TetMesh& mesh, const Tetrahedron& t) {
  double longest = 0;
  for (const auto& [i, j, k, l] : kEdges) {
    longest = std::max(longest, (mesh.vertices[t[i]] - mesh.vertices[t[j]]).norm());
  }
  return longest;
}

void check_coordinates(const TetMesh& mesh, const std::string& source) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3& x = mesh.vertices[i];
    if (!x.allFinite()) {
      fail("{}: vertex {} is at {}: every coordinate must be a finite number; export the mesh again", source,
           i, text(x));
    }
  }
}

void check_indices(const TetMesh& mesh, const std::string& source) {
  std::vector<char> used(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    Tetrahedron t = mesh.tetrahedra[i];
    std::sort(t.begin(), t.end());
    for (const int vertex : t) {
      if (vertex < 0 || vertex >= static_cast<int>(used.size())) {
        fail("{}: tetrahedron {} names vertex {}, but the vertices are 0 to {}", source, i, vertex,
             static_cast<int>(used.size()) - 1);
      }
      used[vertex] = 1;
    }
    if (const auto twice = std::adjacent_find(t.begin(), t.end()); twice != t.end()) {
      fail("{}: tetrahedron {} names vertex {} twice; remove it or re-mesh", source, i, *twice);
    }
  }
  if (const auto loose = std::find(used.begin(), used.end(), 0); loose != used.end()) {
    fail("{}: vertex {} belongs to no tetrahedron; remove it", source, loose - used.begin());
  }
}

void check_volumes(const TetMesh& mesh, const std::string& source) {
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    const Tetrahedron& t = mesh.tetrahedra[i];
    const double six_v = six_volumes(mesh, t);
    const bool flat = !(std::abs(six_v) > kFlat * std::pow(longest_edge(mesh, t), 3));  // so that NaN is flat
    if (!flat && six_v > 0) continue;
    const std::string corners =
        fmt::format("{} {} {} {}", text(mesh.vertices[t[0]]), text(mesh.vertices[t[1]]),
                    text(mesh.vertices[t[2]]), text(mesh.vertices[t[3]]));
    fail("{}: tetrahedron {} (vertices {}) is {}: volume {:.3g} m^3 at {}; {}", source, i, fmt::join(t, " "),
         flat ? "flat" : "inverted", six_v / 6, corners,
         flat ? "re-mesh, or move a vertex" : "swap two of its vertices");
  }
}

// The representative of the set that holds `vertex`; halves the path on the way.
int root(std::vector<int>& parent, int vertex) {
  while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
  return vertex;
}

// The number of tetrahedra of each body, largest first.
std::vector<int> body_sizes(const TetMesh& mesh) {
  std::vector<int> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const int vertex : t) parent[root(parent, vertex)] = root(parent, t[0]);
  }
  std::vector<int> size(mesh.vertices.size(), 0);
  for (const Tetrahedron& t : mesh.tetrahedra) ++size[root(parent, t[0])];
  std::sort(size.begin(), size.end(), std::greater<>());
  size.erase(std::find(size.begin(), size.end(), 0), size.end());
  return size;
}

void check_bodies(const TetMesh& mesh, const std::string& source) {
  constexpr std::size_t kShown = 5;
  const std::vector<int> sizes = body_sizes(mesh);
  if (sizes.size() == 1) return;
  const std::vector<int> shown(sizes.begin(), sizes.begin() + std::min(kShown, sizes.size()));
  fail(
      "{}: {} bodies that share no vertex, of {}{} tetrahedra, but the organ is one body; join them or keep "
      "one",
      source, sizes.size(), fmt::join(shown, ", "), sizes.size() > kShown ? ", ..." : "");
}

// The angle between the two faces that meet at edge (a, b), seen from inside; c and d are the other corners.
double dihedral(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 m = (b - a).cross(c - a), n = (b - a).cross(d - a);
  return std::atan2(m.cross(n).norm(), m.dot(n));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void describe_edges(const TetMesh& mesh, MeshInfo& info) {
  std::vector<std::pair<int, int>> edges;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const auto& [i, j, k, l] : kEdges) edges.push_back(std::minmax({t[i], t[j]}));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<double> lengths;
  lengths.reserve(edges.size());
  for (const auto& [a, b] : edges) lengths.push_back((mesh.vertices[a] - mesh.vertices[b]).norm());
  info.edges = static_cast<int>(edges.size());
  info.min_edge = *std::min_element(lengths.begin(), lengths.end());
  info.max_edge = *std::max_element(lengths.begin(), lengths.end());
  info.median_edge = median(std::move(lengths));
}

void describe_tetrahedra(const TetMesh& mesh, MeshInfo& info) {
  const std::vector<Vec3>& x = mesh.vertices;
  std::vector<double> smallest;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    std::array<double, 6> angles{};
    std::transform(kEdges.begin(), kEdges.end(), angles.begin(), [&](const std::array<int, 4>& e) {
      return dihedral(x[t[e[0]]], x[t[e[1]]], x[t[e[2]]], x[t[e[3]]]);
    });
    const auto [least, most] = std::minmax_element(angles.begin(), angles.end());
    smallest.push_back(*least);
    info.max_dihedral = std::max(info.max_dihedral, *most);
    info.volume += six_volumes(mesh, t) / 6;
  }
  info.min_dihedral = *std::min_element(smallest.begin(), smallest.end());
  info.median_min_dihedral = median(std::move(smallest));
}

}  // namespace

double six_volumes(const TetMesh& mesh, const Tetrahedron& t) {
  const std::vector<Vec3>& x = mesh.vertices;
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).dot(x[t[3]] - x[t[0]]);
}

void validate(const TetMesh& mesh, const std::string& source) {
  if (mesh.tetrahedra.empty()) {
    fail(
        "{}: no tetrahedra (4 nodes, Gmsh element type 4); fill the surface first, as `gmsh -3 MODEL.geo` "
        "does",
        source);
  }
  check_coordinates(mesh, source);
  check_indices(mesh, source);
  check_volumes(mesh, source);
  check_bodies(mesh, source);
}

MeshInfo describe(const TetMesh& mesh) {
  MeshInfo info;
  if (mesh.tetrahedra.empty()) return info;
  const Surface surface = boundary_surface(mesh);
  info.vertices = static_cast<int>(mesh.vertices.size());
  info.tetrahedra = static_cast<int>(mesh.tetrahedra.size());
  info.boundary_vertices = static_cast<int>(surface.vertices.size());
  info.boundary_triangles = static_cast<int>(surface.triangles.size());
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
