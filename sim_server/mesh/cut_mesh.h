#pragma once
/// A mesh of which tetrahedra are removed while it is in use.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim_server/mesh/surface.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Whether a tetrahedron may be removed.
enum class Removable : char {
  kNever,
  kLater,  ///< once it was allowed
  kNow,
};

/// What is left of a mesh while tetrahedra are removed, and its surface. A removal looks at the tetrahedron
/// and at the four across its faces: O(1), whatever the size of the mesh. Faces between two that are left
/// become surface when one of them goes, outward from the other; those on the surface go with their
/// tetrahedron. So the surface stays closed: each edge is on an even number of triangles, of opposite turns.
/// Where what is left meets in an edge or a vertex only, the surface is not one sheet there, and the tissue
/// is joined by a hinge or a ball joint, as in the mesh that is left. One thread.
class CutMesh {
 public:
  /// Gives `surface`, the boundary of `mesh`, the vertices of the tetrahedra that may ever be removed, in
  /// whose numbers its triangles are from then on. `removable`: of each tetrahedron. The mesh outlives this.
  /// O(m log m).
  CutMesh(const TetMesh& mesh, std::vector<Removable> removable, Surface& surface);

  const TetMesh& mesh() const { return mesh_; }
  bool is_left(int tetrahedron) const { return left_[static_cast<std::size_t>(tetrahedron)] != 0; }
  Removable removable(int tetrahedron) const { return removable_[static_cast<std::size_t>(tetrahedron)]; }
  bool is_removable(int tetrahedron) const { return removable(tetrahedron) == Removable::kNow; }
  /// From now on these may be removed, of which that was said for later.
  void allow(std::span<const int> tetrahedra);
  std::size_t count() const { return count_; }  ///< of what is left
  /// All tetrahedra around a mesh vertex, left or not, ascending.
  std::span<const int> around(int vertex) const;
  /// Across each face of a tetrahedron, that opposite to its corner k: another that is left, or -1.
  std::array<int, 4> neighbours(int tetrahedron) const;
  /// Of the surface triangle in place `slot`: whose face it is.
  int tetrahedron_of(std::size_t slot) const { return faces_[slot] / 4; }
  /// Of the surface that was inside at first, at rest, m^2.
  double cut_area() const { return cut_area_; }
  /// Whether any triangle has this surface vertex as a corner.
  bool on_surface(int vertex) const { return uses_[static_cast<std::size_t>(vertex)] > 0; }

  /// Removes these that are left: some that may be, or a whole piece that hangs on nothing else. The places
  /// of triangles in `surface` change: the last one fills a gap.
  void remove(std::span<const int> tetrahedra, Surface& surface);

  std::size_t bytes() const;

 private:
  double area_of(int face) const;
  void add_triangle(int face, Surface& surface);
  void drop_triangle(int face, Surface& surface);

  const TetMesh& mesh_;
  std::vector<std::array<int, 4>> neighbours_;  // of each tetrahedron, at first
  std::vector<char> left_;                      // of tetrahedra
  std::vector<Removable> removable_;
  std::vector<char> inner_;  // of faces, 4 t + k: inside at first
  std::size_t count_;
  double cut_area_ = 0;                     // m^2
  std::vector<int> around_, around_first_;  // of mesh vertices
  std::vector<int> number_;                 // of mesh vertices on the surface, or -1
  std::vector<int> faces_, slot_;  // of each triangle its face 4 t + k; of each face its place, or -1
  std::vector<int> uses_;          // of surface vertices
};

}  // namespace palpate::sim
