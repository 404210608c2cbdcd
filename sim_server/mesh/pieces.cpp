#include "sim_server/mesh/pieces.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace palpate::sim {
namespace {

/// The one that stays: the largest of those that are held, or else the largest.
auto piece_that_stays(std::vector<Piece>& pieces) {
  return std::ranges::max_element(pieces, [](const Piece& a, const Piece& b) {
    return std::pair(a.held, a.volume) < std::pair(b.held, b.volume);
  });
}

}  // namespace

PieceFinder::PieceFinder(const TetMesh& mesh, std::span<const int> held)
    : held_(mesh.vertices.size()), front_of_(mesh.tetrahedra.size(), -1) {
  for (const int v : held) held_[static_cast<std::size_t>(v)] = 1;
}

std::vector<PieceFinder::Front> PieceFinder::fronts_around(const CutMesh& mesh,
                                                           std::span<const int> removed) {
  std::vector<Front> fronts;
  for (const int t : removed) {
    for (const int other : mesh.neighbours(t)) {
      if (other < 0 || front_of_[static_cast<std::size_t>(other)] >= 0) continue;
      front_of_[static_cast<std::size_t>(other)] = static_cast<int>(fronts.size());
      fronts.push_back({.reached = {other}});
    }
  }
  return fronts;
}

/// Looks around one more tetrahedron of a front that has one.
void PieceFinder::grow(const CutMesh& mesh, Front& front, int number) {
  for (const int other : mesh.neighbours(front.reached[front.next++])) {
    if (other < 0 || front_of_[static_cast<std::size_t>(other)] >= 0) continue;
    front_of_[static_cast<std::size_t>(other)] = number;
    front.reached.push_back(other);
  }
}

Piece PieceFinder::piece_of(const CutMesh& mesh, std::vector<int> tetrahedra) const {
  Piece piece{.tetrahedra = std::move(tetrahedra)};
  std::sort(piece.tetrahedra.begin(), piece.tetrahedra.end());
  for (const int t : piece.tetrahedra) {
    const Tetrahedron& corners = mesh.mesh().tetrahedra[static_cast<std::size_t>(t)];
    piece.volume += six_volumes(mesh.mesh(), corners) / 6;
    for (const int v : corners) piece.held = piece.held || held_[static_cast<std::size_t>(v)] != 0;
  }
  return piece;
}

/// Grows all fronts in turns, and joins those that meet, until the ones that are not at an end are of one
/// set. Returns that set, or -1 where all are at an end: each set is a piece then.
int PieceFinder::grow_until_apart(const CutMesh& mesh, std::vector<Front>& fronts, DisjointSets& sets) {
  std::vector<int> growing(fronts.size());
  std::iota(growing.begin(), growing.end(), 0);
  const auto of_one_set = [&] {
    return std::ranges::all_of(growing, [&](int f) { return sets.of(f) == sets.of(growing[0]); });
  };
  while (!of_one_set()) {
    for (const int f : growing) {
      Front& front = fronts[static_cast<std::size_t>(f)];
      const int around = front.reached[front.next];
      grow(mesh, front, f);
      for (const int other : mesh.neighbours(around)) {
        if (other >= 0) sets.join(f, front_of_[static_cast<std::size_t>(other)]);
      }
    }
    std::erase_if(growing, [&](int f) {
      const Front& front = fronts[static_cast<std::size_t>(f)];
      return front.next == front.reached.size();
    });
  }
  return growing.empty() ? -1 : sets.of(growing[0]);
}

std::vector<Piece> PieceFinder::cut_off(const CutMesh& mesh, std::span<const int> removed) {
  std::vector<Front> fronts = fronts_around(mesh, removed);
  DisjointSets sets(fronts.size());
  const int rest = grow_until_apart(mesh, fronts, sets);
  std::map<int, Front> whole;  // of each set
  for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
    std::vector<int>& reached = whole[sets.of(f)].reached;
    reached.insert(reached.end(), fronts[static_cast<std::size_t>(f)].reached.begin(),
                   fronts[static_cast<std::size_t>(f)].reached.end());
  }
  std::vector<Piece> pieces;
  for (const auto& [set, front] : whole) {
    if (set != rest) pieces.push_back(piece_of(mesh, front.reached));
  }
  // What was not followed is large; it stays unless something else is held, and it is not.
  const bool all_known = rest < 0 || std::ranges::any_of(pieces, &Piece::held);
  if (rest >= 0 && all_known) {
    Front& front = whole[rest];
    while (front.next < front.reached.size()) grow(mesh, front, rest);
    pieces.push_back(piece_of(mesh, front.reached));
  }
  if (all_known && !pieces.empty()) pieces.erase(piece_that_stays(pieces));
  for (const auto& [set, front] : whole) {
    for (const int t : front.reached) front_of_[static_cast<std::size_t>(t)] = -1;
  }
  return pieces;
}

}  // namespace palpate::sim
