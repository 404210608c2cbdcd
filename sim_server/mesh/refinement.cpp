#include "sim_server/mesh/refinement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace palpate::sim {
namespace {

/// Middles (by `kEdges`) of opposite edges: the diagonals of the octahedron between the corners.
constexpr std::array<std::array<int, 2>, 3> kDiagonals{{{0, 5}, {1, 3}, {2, 4}}};

void add(TetMesh& mesh, Tetrahedron t) {
  if (six_volumes(mesh, t) < 0) std::swap(t[2], t[3]);
  mesh.tetrahedra.push_back(t);
}

/// The octahedron, in four tetrahedra around its shortest diagonal.
void cut_octahedron(const std::array<int, 6>& middle, TetMesh& mesh) {
  const auto length = [&](const std::array<int, 2>& d) {
    return (mesh.vertices[middle[d[0]]] - mesh.vertices[middle[d[1]]]).squaredNorm();
  };
  const auto shortest = std::ranges::min_element(
      kDiagonals, [&](const auto& a, const auto& b) { return length(a) < length(b); });
  const std::size_t axis = static_cast<std::size_t>(shortest - kDiagonals.begin());
  const auto &side = kDiagonals[(axis + 1) % 3], &other = kDiagonals[(axis + 2) % 3];
  const std::array<int, 4> ring{side[0], other[0], side[1], other[1]};  // around the diagonal
  for (std::size_t k = 0; k < 4; ++k)
    add(mesh, {middle[(*shortest)[0]], middle[(*shortest)[1]], middle[ring[k]], middle[ring[(k + 1) % 4]]});
}

/// An edge by its ends, the lower first.
using Edge = std::array<int, 2>;

Edge edge_of(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

/// Middles of `edges`, the last vertices of `fine`, have a tag where a tagged triangle of `coarse` has the
/// edge; of a tag without triangles, where both ends have it.
void tag_middles(const std::vector<Edge>& edges, const TetMesh& coarse, TetMesh& fine) {
  const std::size_t first = fine.vertices.size() - edges.size();
  for (auto& [name, tagged] : fine.surface_tags) {
    std::set<Edge> sides;
    const auto triangles = coarse.tagged_triangles.find(name);
    const bool has_triangles = triangles != coarse.tagged_triangles.end();
    if (has_triangles) {
      for (const auto& [a, b, c] : triangles->second)
        sides.insert({edge_of(a, b), edge_of(b, c), edge_of(a, c)});
    }
    std::vector<std::uint8_t> has(first, 0);
    for (const int v : tagged) has[v] = 1;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const auto [a, b] = edges[k];
      if (has_triangles ? sides.contains(edge_of(a, b)) : has[a] != 0 && has[b] != 0)
        tagged.push_back(static_cast<int>(first + k));
    }
  }
}

/// Edges are ordered by length, those of equal length by their ends.
using Ranked = std::pair<double, Edge>;

Ranked ranked_longest_edge(const TetMesh& mesh, const Tetrahedron& t) {
  Ranked most{-1, {}};
  for (const auto& [a, b] : kEdges) {
    const Edge edge = edge_of(t[a], t[b]);
    most = std::max(most, {(mesh.vertices[edge[1]] - mesh.vertices[edge[0]]).squaredNorm(), edge});
  }
  return most;
}

/// The edges to cut, longest first: the longest ones of tetrahedra that are `too_large`, and of all that are
/// cut for their neighbours' sake.
std::vector<Edge> edges_to_cut(const TetMesh& mesh,
                               const std::function<bool(const Tetrahedron&, double)>& too_large) {
  std::vector<Ranked> longest;
  std::set<Edge> cut;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    longest.push_back(ranked_longest_edge(mesh, t));
    if (too_large(t, std::sqrt(longest.back().first))) cut.insert(longest.back().second);
  }
  const auto is_cut = [&](const Tetrahedron& t) {
    return std::ranges::any_of(kEdges,
                               [&](const auto& e) { return cut.contains(edge_of(t[e[0]], t[e[1]])); });
  };
  for (std::size_t before = 0; before != cut.size();) {
    before = cut.size();
    for (std::size_t t = 0; t < longest.size(); ++t) {
      if (is_cut(mesh.tetrahedra[t])) cut.insert(longest[t].second);
    }
  }
  std::ranges::sort(longest, std::greater<>());
  longest.erase(std::unique(longest.begin(), longest.end()), longest.end());
  std::vector<Edge> edges;
  for (const auto& [length, edge] : longest) {
    if (cut.contains(edge)) edges.push_back(edge);
  }
  return edges;
}

/// A triangle or tetrahedron in parts: halved at each of its edges that has a middle, in the order of these.
template <std::size_t N>
std::vector<std::array<int, N>> halves_of(const std::array<int, N>& entire,
                                          const std::map<Edge, int>& middle_of) {
  std::vector<std::pair<int, Edge>> cuts;
  for (std::size_t a = 0; a < N; ++a) {
    for (std::size_t b = a + 1; b < N; ++b) {
      const auto found = middle_of.find(edge_of(entire[a], entire[b]));
      if (found != middle_of.end()) cuts.emplace_back(found->second, found->first);
    }
  }
  std::ranges::sort(cuts);
  std::vector<std::array<int, N>> parts{entire};
  for (const auto& [middle, ends] : cuts) {
    for (std::size_t k = 0, count = parts.size(); k < count; ++k) {
      const auto first = std::ranges::find(parts[k], ends[0]), second = std::ranges::find(parts[k], ends[1]);
      if (first == parts[k].end() || second == parts[k].end()) continue;
      std::array<int, N> other = parts[k];
      other[static_cast<std::size_t>(first - parts[k].begin())] = middle;
      *second = middle;
      parts.push_back(other);
    }
  }
  return parts;
}

TetMesh cut_at(const std::vector<Edge>& edges, const TetMesh& mesh) {
  TetMesh fine{.vertices = mesh.vertices, .tetrahedra = {}, .surface_tags = mesh.surface_tags};
  std::map<Edge, int> middle_of;
  for (const Edge& edge : edges) {
    middle_of[edge] = static_cast<int>(fine.vertices.size());
    fine.vertices.push_back((mesh.vertices[edge[0]] + mesh.vertices[edge[1]]) / 2);
  }
  tag_middles(edges, mesh, fine);
  for (const auto& [name, triangles] : mesh.tagged_triangles) {
    for (const Triangle& triangle : triangles) {
      for (const Triangle& part : halves_of(triangle, middle_of)) fine.tagged_triangles[name].push_back(part);
    }
  }
  sort_tags(fine);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (const Tetrahedron& part : halves_of(mesh.tetrahedra[t], middle_of)) {
      fine.tetrahedra.push_back(part);
      if (!mesh.stiffness.empty()) fine.stiffness.push_back(mesh.stiffness[t]);
    }
  }
  return fine;
}

}  // namespace

TetMesh halved(const TetMesh& mesh) {
  return cut_at(edges_to_cut(mesh, [](const Tetrahedron&, double) { return true; }), mesh);
}

TetMesh graded(TetMesh mesh, const std::function<double(const Vec3&)>& longest) {
  while (true) {
    const std::vector<Edge> edges = edges_to_cut(mesh, [&](const Tetrahedron& t, double length) {
      const auto& x = mesh.vertices;
      return length > longest((x[t[0]] + x[t[1]] + x[t[2]] + x[t[3]]) / 4);
    });
    if (edges.empty()) return mesh;
    mesh = cut_at(edges, mesh);
  }
}

TetMesh refined(const TetMesh& mesh) {
  TetMesh with_middles = mesh;
  add_mid_edges(with_middles);
  TetMesh fine{.vertices = with_middles.vertices, .tetrahedra = {}, .surface_tags = mesh.surface_tags};
  tag_middles(with_middles.mid_edges, mesh, fine);
  for (const auto& [name, triangles] : mesh.tagged_triangles) {
    for (const auto& [a, b, c] : triangles) {
      const int ab = with_middles.middle(a, b), bc = with_middles.middle(b, c),
                ac = with_middles.middle(a, c);
      for (const Triangle& t :
           {Triangle{a, ab, ac}, Triangle{b, ab, bc}, Triangle{c, ac, bc}, Triangle{ab, bc, ac}})
        fine.tagged_triangles[name].push_back(t);
    }
  }
  sort_tags(fine);
  for (const double stiffness : mesh.stiffness) fine.stiffness.insert(fine.stiffness.end(), 8, stiffness);
  for (const Tetrahedron& t : mesh.tetrahedra) {
    std::array<int, 6> middle{};
    for (std::size_t e = 0; e < 6; ++e) middle[e] = with_middles.middle(t[kEdges[e][0]], t[kEdges[e][1]]);
    for (int corner = 0; corner < 4; ++corner) {
      Tetrahedron small{t[corner], 0, 0, 0};
      int next = 1;
      for (std::size_t e = 0; e < 6; ++e) {
        if (kEdges[e][0] == corner || kEdges[e][1] == corner) small[next++] = middle[e];
      }
      add(fine, small);
    }
    cut_octahedron(middle, fine);
  }
  return fine;
}

}  // namespace palpate::sim
