#pragma once
/// A mesh of which tetrahedra are removed while it is in use.
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "sim_server/mesh/surface.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// A vertex that became two, as the tetrahedra around it hang together by faces no more: some of them have
/// `copy` as a corner now.
struct Split {
  int vertex, copy;
};

/// Changes of a mesh by the separation of faces.
struct Parting {
  std::vector<int> tetrahedra;  ///< on both sides of the faces, ascending
  std::vector<Split> splits;    ///< in order
  /// Tetrahedra that have other corners now, ascending, and those they had before.
  std::vector<std::pair<int, Tetrahedron>> changed;
  bool ran_out = false;  ///< of vertices: some stayed one that should be two
};

/// Remaining mesh while tetrahedra are removed, and its surface. A removal visits the tetrahedron and its
/// four face neighbours: O(1), whatever the size of the mesh. Faces between two remaining tetrahedra become
/// surface when one of them is removed, outward from the other; faces on the surface vanish with their
/// tetrahedron. So the surface stays closed: each edge is on an even number of triangles, of opposite turns.
/// The surface is not one sheet at an edge or a vertex that alone joins two parts of the remaining mesh; it
/// is a hinge or a ball joint of the tissue, as in that mesh. One thread.
class CutMesh {
 public:
  /// Gives `surface`, the boundary of `mesh`, the vertices of the tetrahedra that may ever be removed, in
  /// whose numbers its triangles are from then on. `removable`: 1 for each tetrahedron that may be removed,
  /// else 0. The mesh outlives this. O(m log m).
  CutMesh(const TetMesh& mesh, std::vector<char> removable, Surface& surface);
  /// A mesh whose faces can be parted, too. It gets a spare vertex for each of those that may be removed,
  /// after all others, which `surface` then has, too. `held`: vertices that stay one and where they are,
  /// ascending.
  CutMesh(TetMesh& mesh, std::vector<char> removable, Surface& surface, std::span<const int> held);

  /// Returns a copy that refers to `mesh`, a copy of its mesh, which outlives the result: for another thread,
  /// read-only.
  CutMesh of_copy(const TetMesh& mesh) const {
    CutMesh same = *this;
    same.mesh_ = &mesh;
    same.separated_ = nullptr;
    return same;
  }

  const TetMesh& mesh() const { return *mesh_; }
  bool remains(int tetrahedron) const { return remaining_[static_cast<std::size_t>(tetrahedron)] != 0; }
  bool is_removable(int tetrahedron) const { return removable_[static_cast<std::size_t>(tetrahedron)] != 0; }
  std::size_t count() const { return count_; }  ///< of what is left
  /// Returns all tetrahedra around a mesh vertex, removed ones too, ascending.
  std::span<const int> around(int vertex) const;
  /// Across each face of a tetrahedron, that opposite to its corner k: another that is left, or -1.
  std::array<int, 4> neighbours(int tetrahedron) const;
  /// Returns the tetrahedron of the surface triangle in place `slot`.
  int tetrahedron_of(std::size_t slot) const { return faces_[slot] / 4; }
  /// Returns the area of the surface that was inside at first, at rest, m^2.
  double cut_area() const { return cut_area_; }
  /// Returns the surface vertex of a mesh vertex; -1 where it can never be on the surface.
  int number_of(int vertex) const { return number_[static_cast<std::size_t>(vertex)]; }
  /// Vertices that are of no tetrahedron yet, ascending.
  std::pair<int, int> spares() const { return {next_spare_, spares_end_}; }
  /// True if any triangle has this surface vertex as a corner.
  bool on_surface(int vertex) const { return uses_[static_cast<std::size_t>(vertex)] > 0; }

  /// Removes these that are left: some that may be, or a whole piece that hangs on nothing else. The places
  /// of triangles in `surface` change: the last one fills a gap.
  void remove(std::span<const int> tetrahedra, Surface& surface);

  double area_of(int face) const;       ///< of face 4 t + k, at rest, m^2
  Vec3 centre_of_face(int face) const;  ///< m
  /// True if face 4 t + k of a remaining tetrahedron is surface.
  bool is_surface(int face) const { return slot_[static_cast<std::size_t>(face)] >= 0; }
  /// Returns, of face 4 t + k, the number of that face in the other tetrahedron; -1: it is surface.
  int across(int face) const;
  /// True if both tetrahedra of a face can be removed.
  bool can_part(int face) const;
  /// True if this vertex can become two, or be moved: all tetrahedra around it can be removed, and it is not
  /// fixed.
  bool is_free(int vertex) const;
  /// True if it is a corner of a face that was inside at first, and is surface now.
  bool on_cut(int vertex) const;
  /// Parts these faces, 4 t + k, that `can_part`: both sides become surface. Where the tetrahedra around a
  /// vertex that `is_free` hang together by faces no more, all but the most that do get a vertex of their
  /// own. So a face whose corners all stay one is a slit of no width. O(faces), whatever the size of the
  /// mesh.
  Parting part(std::span<const int> faces, Surface& surface);
  /// Puts a vertex elsewhere, at rest, m. Of a mesh whose faces can be parted.
  void move_vertex(int vertex, const Vec3& x);

  std::size_t bytes() const;

 private:
  int facing(int other, int tetrahedron) const;
  void add_triangle(int face, Surface& surface);
  void drop_triangle(int face, Surface& surface);
  void add_spares(std::span<const int> held, Surface& surface);
  using Changed = std::map<int, Tetrahedron>;
  void split(int vertex, Surface& surface, Parting& parting, Changed& changed);
  std::vector<std::vector<int>> fans_around(int vertex) const;
  void give(const std::vector<int>& fan, const Split& split, Surface& surface, Changed& changed);
  double cut_area_around(int vertex) const;

  const TetMesh* mesh_;
  TetMesh* separated_ = nullptr;  // the same, where its faces can be parted
  std::vector<char> held_;        // of vertices, then
  int next_spare_ = 0, spares_end_ = 0;
  std::vector<std::array<int, 4>> neighbours_;  // of each tetrahedron, at first, but for faces parted since
  std::vector<char> remaining_;                 // of tetrahedra
  std::vector<char> removable_;
  std::vector<char> inner_;  // of faces, 4 t + k: inside at first
  std::size_t count_;
  double cut_area_ = 0;                                  // m^2
  std::vector<int> around_, around_first_, around_end_;  // of mesh vertices
  std::vector<int> number_;                              // of mesh vertices on the surface, or -1
  std::vector<int> faces_, slot_;  // of each triangle its face 4 t + k; of each face its place, or -1
  std::vector<int> uses_;          // of surface vertices
};

}  // namespace palpate::sim
