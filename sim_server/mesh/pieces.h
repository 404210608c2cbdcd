#pragma once
/// Pieces of a mesh that come apart while tetrahedra are removed.
#include <span>
#include <vector>

#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/mesh/disjoint_sets.h"

namespace palpate::sim {

/// Tetrahedra that hang together by whole faces.
struct Piece {
  std::vector<int> tetrahedra;  ///< ascending
  bool held = false;            ///< some of its vertices are
  double volume = 0;            ///< at rest, m^3
};

/// Finds what removals cut off. One thread.
class PieceFinder {
 public:
  /// `held`: vertices that are fixed, ascending. O(m).
  PieceFinder(const CutMesh& mesh, std::span<const int> held);

  /// Returns the pieces that the removal of these tetrahedra, just now, has cut off. Of each body that hung
  /// together before, they are all pieces but one. That one is a held piece, where any is held, and else the
  /// largest. It is returned, too, where the body was held until now and its last support was removed.
  /// Searches from the neighbours of the removed tetrahedra, in turns, until all searches have merged but
  /// those that exhausted their piece. Cost O(pieces cut off), and a search of some tetrahedra around where
  /// nothing is cut off; of a body without supports O(that).
  std::vector<Piece> cut_off(const CutMesh& mesh, std::span<const int> removed);
  /// Returns the pieces that were cut off by the separation of faces, just now, between these remaining
  /// tetrahedra.
  std::vector<Piece> separated(const CutMesh& mesh, std::span<const int> tetrahedra);
  /// Returns the tetrahedra, ascending, of each part that floats: it hangs together by vertices, and nothing
  /// holds any of it. O(m).
  std::vector<std::vector<int>> floating(const CutMesh& mesh) const;

 private:
  /// Tetrahedra that one search has reached, in order; those from `next` on have unvisited neighbours.
  struct Front {
    std::vector<int> reached;
    std::size_t next = 0;
  };
  template <class FrontsOf>
  std::vector<Piece> cut_off_by(const CutMesh& mesh, std::span<const int> tetrahedra,
                                const FrontsOf& fronts_of);
  std::vector<Piece> cut_off_body(const CutMesh& mesh, std::vector<Front> fronts, int body);
  void name_bodies(std::vector<Piece>& pieces);
  std::vector<Front> fronts_around(const CutMesh& mesh, std::span<const int> removed);
  std::vector<Front> fronts_at(std::span<const int> tetrahedra);
  void grow(const CutMesh& mesh, Front& front, int number);
  int grow_until_separate(const CutMesh& mesh, std::vector<Front>& fronts, DisjointSets& sets);
  bool releases(const CutMesh& mesh, int removed) const;
  Piece piece_of(const CutMesh& mesh, std::vector<int> tetrahedra) const;

  std::vector<char> held_;    // of vertices
  std::vector<int> body_of_;  // of tetrahedra: which hang together
  std::vector<char> body_held_;
  std::vector<char> released_;  // of bodies: a held vertex is of nothing any more
  std::vector<int> front_of_;   // of tetrahedra, during a search; -1: not reached
};

}  // namespace palpate::sim
