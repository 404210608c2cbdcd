#pragma once
/// The solid: a tetrahedral mesh at rest, in metres.
#include <array>
#include <map>
#include <string>
#include <vector>

#include "common/types.h"

namespace palpate::sim {

using Tetrahedron = std::array<int, 4>;
using Triangle = std::array<int, 3>;

/// The corners of the edges of a tetrahedron, in the order in which quadratic elements number their middles.
constexpr std::array<std::array<int, 2>, 6> kEdges{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Vertices and positively oriented tetrahedra: det(x1-x0, x2-x0, x3-x0) > 0. `mend` sees to it.
struct TetMesh {
  std::vector<Vec3> vertices;           ///< (n), metres, mesh frame at rest
  std::vector<Tetrahedron> tetrahedra;  ///< (m), indices into `vertices`
  /// Vertices of each named (or numbered, "17") surface the file tags; empty where it tags none.
  std::map<std::string, std::vector<int>> surface_tags;
  /// Triangles of each such surface as the file has them: corners ascending, and so the list.
  std::map<std::string, std::vector<Triangle>> tagged_triangles = {};
  /// Number of tetrahedra in each named (or numbered) group of volumes, as the file has them.
  std::map<std::string, std::size_t> volume_tags = {};
  /// The two corners, ascending, of the edge in whose middle each of the last vertices is. All edges of the
  /// mesh, ascending (`add_mid_edges`), or none.
  std::vector<std::array<int, 2>> mid_edges = {};
  /// (m) How stiff each tetrahedron is, as a multiple of its material; empty: all 1 (`put_inclusions`).
  std::vector<double> stiffness = {};

  /// Vertices that are corners of tetrahedra: the first ones.
  int corners() const { return static_cast<int>(vertices.size() - mid_edges.size()); }
  /// The vertex in the middle of the edge between two corners, either way round, where there are such.
  /// O(log n).
  int middle(int a, int b) const;
};

/// Puts one more vertex in the middle of each edge of a mesh that `mend` found usable, as elements with ten
/// nodes need it; nothing where they are there. O(m log m).
void add_mid_edges(TetMesh& mesh);

/// Leaves of `mesh` the tetrahedra t of which `keep(t)`, in their order, and all vertices. O(m).
template <class Keep>
void keep_tetrahedra(TetMesh& mesh, const Keep& keep) {
  std::size_t stored = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (!keep(t)) continue;
    mesh.tetrahedra[stored] = mesh.tetrahedra[t];
    if (!mesh.stiffness.empty()) mesh.stiffness[stored] = mesh.stiffness[t];
    ++stored;
  }
  mesh.tetrahedra.resize(stored);
  if (!mesh.stiffness.empty()) mesh.stiffness.resize(stored);
}

/// Puts tagged vertices and triangles in order, each once, and drops those below 0.
void sort_tags(TetMesh& mesh);

/// Six times the signed volume of tetrahedron `t`, m^3.
double six_volumes(const TetMesh& mesh, const Tetrahedron& t);

/// The mean of the corners of tetrahedron `t`, m.
Vec3 centre_of(const TetMesh& mesh, const Tetrahedron& t);

/// The smallest of the six dihedral angles of `t`, radians; of one that is flat 0.
double smallest_dihedral(const TetMesh& mesh, const Tetrahedron& t);

/// The shortest distance from a corner of `t` to the face across from it, m.
double shortest_height(const TetMesh& mesh, const Tetrahedron& t);

/// Figures that `sim_server mesh info` prints of a valid mesh.
struct MeshInfo {
  int vertices = 0, edges = 0, tetrahedra = 0, boundary_vertices = 0, boundary_triangles = 0;
  double volume = 0;                            ///< m^3
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  ///< bounding box, m
  double min_dihedral = 0, max_dihedral = 0;    ///< radians
  double median_min_dihedral = 0;  ///< median over tetrahedra of the smallest dihedral angle, radians
  double min_edge = 0, median_edge = 0, max_edge = 0;  ///< m
};

/// Counts, size and quality of a mesh that `mend` found usable, without what `add_mid_edges` put there.
/// O(m log m).
MeshInfo describe(const TetMesh& mesh);

}  // namespace palpate::sim
