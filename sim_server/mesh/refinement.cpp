#include "sim_server/mesh/refinement.h"

#include <algorithm>

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
  const auto shortest = std::min_element(kDiagonals.begin(), kDiagonals.end(),
                                         [&](const auto& a, const auto& b) { return length(a) < length(b); });
  const std::size_t axis = static_cast<std::size_t>(shortest - kDiagonals.begin());
  const auto &side = kDiagonals[(axis + 1) % 3], &other = kDiagonals[(axis + 2) % 3];
  const std::array<int, 4> ring{side[0], other[0], side[1], other[1]};  // around the diagonal
  for (std::size_t k = 0; k < 4; ++k)
    add(mesh, {middle[(*shortest)[0]], middle[(*shortest)[1]], middle[ring[k]], middle[ring[(k + 1) % 4]]});
}

}  // namespace

TetMesh refined(const TetMesh& mesh) {
  TetMesh with_middles = mesh;
  add_mid_edges(with_middles);
  TetMesh fine{.vertices = with_middles.vertices, .tetrahedra = {}, .surface_tags = mesh.surface_tags};
  for (auto& [name, tagged] : fine.surface_tags) {
    std::vector<std::uint8_t> has(mesh.vertices.size(), 0);
    for (const int v : tagged) has[v] = 1;
    for (std::size_t k = 0; k < with_middles.mid_edges.size(); ++k) {
      const auto [a, b] = with_middles.mid_edges[k];
      if (has[a] != 0 && has[b] != 0) tagged.push_back(static_cast<int>(mesh.vertices.size() + k));
    }
  }
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
