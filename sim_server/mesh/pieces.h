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

  /// What the removal of these tetrahedra, just now, has cut off: of each body that hung together before, all
  /// pieces but one. That one is held, where any is, and else the largest; but it is told, too, where the
  /// body was held until now and the last that held it is gone. Searches from the neighbours of what was
  /// removed, in turns, until all of them have met but those of pieces that are at an end: O(what is cut off)
  /// and a search of some tetrahedra around where nothing is; of a body that nothing holds O(that).
  std::vector<Piece> cut_off(const CutMesh& mesh, std::span<const int> removed);
  /// The same of faces that were parted, just now, between these tetrahedra, which are left.
  std::vector<Piece> parted(const CutMesh& mesh, std::span<const int> tetrahedra);

 private:
  /// What one search has reached, in order; from `next` on, what it has not looked around yet.
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
  int grow_until_apart(const CutMesh& mesh, std::vector<Front>& fronts, DisjointSets& sets);
  bool lets_go(const CutMesh& mesh, int removed) const;
  Piece piece_of(const CutMesh& mesh, std::vector<int> tetrahedra) const;

  std::vector<char> held_;    // of vertices
  std::vector<int> body_of_;  // of tetrahedra: which hang together
  std::vector<char> body_held_;
  std::vector<char> let_go_;   // of bodies: a held vertex is of nothing any more
  std::vector<int> front_of_;  // of tetrahedra, during a search; -1: not reached
};

}  // namespace palpate::sim
