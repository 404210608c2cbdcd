#include "sim_server/mesh/coincident_vertices.h"

#include <algorithm>
#include <fmt/ranges.h>
#include <numeric>
#include <utility>

#include "sim_server/mesh/connectivity.h"
#include "sim_server/mesh/surface.h"

namespace palpate::sim {
namespace {

double diagonal(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = low;
  for (const Vec3& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).norm();
}

/// Gives coordinates along `axis` that differ by no more than `tolerance` one rank.
void rank(const std::vector<Vec3>& points, int axis, double tolerance,
          std::vector<std::array<int, 3>>& ranks) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](int a, int b) { return points[a][axis] < points[b][axis]; });
  int now = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && points[order[i]][axis] - points[order[i - 1]][axis] > tolerance) ++now;
    ranks[order[i]][axis] = now;
  }
}

/// (n) The first vertex in the same place as each.
std::vector<int> first_in_place(const std::vector<Vec3>& points, double tolerance) {
  std::vector<std::array<int, 3>> ranks(points.size());
  for (int axis = 0; axis < 3; ++axis) rank(points, axis, tolerance, ranks);
  std::vector<int> order(points.size()), first(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](int a, int b) { return std::tie(ranks[a], a) < std::tie(ranks[b], b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && ranks[order[i]] == ranks[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

std::string both_at(const TetMesh& mesh, int a, int b) {
  const Vec3& x = mesh.vertices[a];
  return fmt::format("vertices {} and {} are both at ({:g}, {:g}, {:g})", a, b, x[0], x[1], x[2]);
}

/// The reason why vertices are not merged: an example and a remedy, or nothing.
using Obstacle = std::pair<std::string, std::string>;

Obstacle within_a_tetrahedron(const TetMesh& mesh, const std::vector<int>& first) {
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const Tetrahedron& t = mesh.tetrahedra[e];
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        if (t[i] == t[j] || first[t[i]] != first[t[j]]) continue;
        const auto [a, b] = std::minmax(t[i], t[j]);
        return {fmt::format("{}, and merging them would flatten tetrahedron {}", both_at(mesh, a, b), e),
                "re-mesh, or move one of them"};
      }
    }
  }
  return {};
}

Obstacle within_a_body(const TetMesh& mesh, const std::vector<int>& first, double tolerance) {
  const std::vector<int> body = body_of_vertices(mesh);
  std::vector<std::array<int, 3>> at;  // place, body, vertex
  for (int v = 0; v < static_cast<int>(first.size()); ++v) at.push_back({first[v], body[v], v});
  std::ranges::sort(at);
  const auto twice = std::adjacent_find(
      at.begin(), at.end(), [](const auto& a, const auto& b) { return a[0] == b[0] && a[1] == b[1]; });
  if (twice == at.end()) return {};
  return {
      fmt::format("{}, in one body: a seam, or the sides of a slit", both_at(mesh, (*twice)[2], twice[1][2])),
      fmt::format(
          "merge them if it is a seam (`Coherence Mesh;` in Gmsh); move them more than {:.2g} m apart "
          "if it is a slit",
          tolerance)};
}

bool has_repeated(const TetMesh& mesh) {
  std::vector<Tetrahedron> sorted = mesh.tetrahedra;
  for (Tetrahedron& t : sorted) std::ranges::sort(t);
  std::ranges::sort(sorted);
  return std::ranges::adjacent_find(sorted) != sorted.end();
}

/// Returns what `merged` has that `mesh` had not.
Obstacle made_by_merging(const TetMesh& mesh, const TetMesh& merged) {
  if (has_repeated(merged)) return {"two tetrahedra lie in one place", "remove one of the two bodies"};
  const OuterFaces before = outer_faces(mesh), after = outer_faces(merged);
  if (after.overlaps.size() > before.overlaps.size())
    return {"bodies overlap there", "cut one of them away, or remove it"};
  const NonManifold sheets_before = non_manifold(before.triangles), sheets = non_manifold(after.triangles);
  if (sheets.edges + sheets.vertices > sheets_before.edges + sheets_before.vertices)
    return {
        "bodies that touch there do not share whole faces, so that they would hang by an edge or a vertex",
        "mesh them as one (`BooleanFragments` in Gmsh), or keep one"};
  return {};
}

}  // namespace

void renumber(TetMesh& mesh, const std::vector<int>& number) {
  for (Tetrahedron& t : mesh.tetrahedra) {
    for (int& vertex : t) vertex = number[vertex];
  }
  for (auto& [name, vertices] : mesh.surface_tags) {
    for (int& vertex : vertices) vertex = number[vertex];
  }
  for (auto& [name, triangles] : mesh.tagged_triangles) {
    for (Triangle& t : triangles) {
      for (int& vertex : t) vertex = number[vertex];
    }
  }
  sort_tags(mesh);
}

void keep_vertices(TetMesh& mesh, const std::vector<char>& keep) {
  std::vector<int> number(mesh.vertices.size(), -1);
  std::size_t stored = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (keep[v] == 0) continue;
    number[v] = static_cast<int>(stored);
    mesh.vertices[stored++] = mesh.vertices[v];
  }
  mesh.vertices.resize(stored);
  renumber(mesh, number);
}

Coincidence merge_coincident(TetMesh& mesh, bool sound) {
  const double tolerance = kSamePlace * diagonal(mesh.vertices);
  const std::vector<int> first = first_in_place(mesh.vertices, tolerance);
  Coincidence found;
  std::vector<char> keep;
  for (int v = 0; v < static_cast<int>(first.size()); ++v) {
    keep.push_back(static_cast<char>(first[v] == v));
    if (first[v] != v && ++found.vertices == 1) found.example = both_at(mesh, first[v], v);
  }
  if (found.vertices == 0) return found;
  Obstacle obstacle = within_a_tetrahedron(mesh, first);
  if (obstacle.first.empty()) obstacle = within_a_body(mesh, first, tolerance);
  if (!obstacle.first.empty()) {
    std::tie(found.example, found.remedy) = obstacle;
    return found;
  }
  if (!sound) {
    found.remedy = "they are merged, where that is safe, once no tetrahedron is flat or inverted";
    return found;
  }
  TetMesh merged = mesh;
  renumber(merged, first);
  keep_vertices(merged, keep);
  obstacle = made_by_merging(mesh, merged);
  if (obstacle.first.empty()) {
    mesh = std::move(merged);
  } else {
    found.example += ", but cannot be merged: " + obstacle.first;
    found.remedy = obstacle.second;
  }
  return found;
}

}  // namespace palpate::sim
