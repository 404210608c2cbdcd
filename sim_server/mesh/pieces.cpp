#include "sim_server/mesh/pieces.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

namespace palpate::sim {
namespace {

/// The one that stays: the largest of those that are held, or else the largest.
auto piece_that_stays(std::vector<Piece>& pieces) {
  return std::ranges::max_element(pieces, [](const Piece& a, const Piece& b) {
    return std::pair(a.held, a.volume) < std::pair(b.held, b.volume);
  });
}

}  // namespace

PieceFinder::PieceFinder(const CutMesh& mesh, std::span<const int> held)
    : held_(mesh.mesh().vertices.size()),
      body_of_(mesh.mesh().tetrahedra.size(), -1),
      front_of_(mesh.mesh().tetrahedra.size(), -1) {
  for (const int v : held) held_[static_cast<std::size_t>(v)] = 1;
  for (int t = 0; t < static_cast<int>(body_of_.size()); ++t) {
    if (body_of_[static_cast<std::size_t>(t)] >= 0 || !mesh.remains(t)) continue;
    Front all{.reached = {t}};
    const int number = front_of_[static_cast<std::size_t>(t)] = static_cast<int>(body_held_.size());
    while (all.next < all.reached.size()) grow(mesh, all, number);
    for (const int reached : all.reached) body_of_[static_cast<std::size_t>(reached)] = number;
    body_held_.push_back(piece_of(mesh, std::move(all.reached)).held ? 1 : 0);
  }
  released_.assign(body_held_.size(), 0);
  front_of_.assign(front_of_.size(), -1);
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

std::vector<PieceFinder::Front> PieceFinder::fronts_at(std::span<const int> tetrahedra) {
  std::vector<Front> fronts;
  for (const int t : tetrahedra) {
    front_of_[static_cast<std::size_t>(t)] = static_cast<int>(fronts.size());
    fronts.push_back({.reached = {t}});
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
  std::ranges::sort(piece.tetrahedra);
  for (const int t : piece.tetrahedra) {
    const Tetrahedron& corners = mesh.mesh().tetrahedra[static_cast<std::size_t>(t)];
    piece.volume += six_volumes(mesh.mesh(), corners) / 6;
    for (const int v : corners) piece.held = piece.held || held_[static_cast<std::size_t>(v)] != 0;
  }
  return piece;
}

/// Grows all fronts in turns, and joins those that meet, until the ones that are not at an end are of one
/// set. Returns that set, or -1 where all are at an end: each set is a piece then.
int PieceFinder::grow_until_separate(const CutMesh& mesh, std::vector<Front>& fronts, DisjointSets& sets) {
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

template <class FrontsOf>
std::vector<Piece> PieceFinder::cut_off_by(const CutMesh& mesh, std::span<const int> tetrahedra,
                                           const FrontsOf& fronts_of) {
  std::map<int, std::vector<int>> of_bodies;
  for (const int t : tetrahedra) of_bodies[body_of_[static_cast<std::size_t>(t)]].push_back(t);
  std::vector<Piece> all;
  for (const auto& [body, of_body] : of_bodies) {
    std::vector<Piece> pieces = cut_off_body(mesh, fronts_of(of_body), body);
    name_bodies(pieces);
    std::ranges::move(pieces, std::back_inserter(all));
  }
  return all;
}

std::vector<Piece> PieceFinder::cut_off(const CutMesh& mesh, std::span<const int> removed) {
  for (const int t : removed) {
    if (releases(mesh, t)) released_[static_cast<std::size_t>(body_of_[static_cast<std::size_t>(t)])] = 1;
  }
  return cut_off_by(mesh, removed,
                    [&](std::span<const int> of_body) { return fronts_around(mesh, of_body); });
}

/// True if a held vertex of this one, which is gone, is of nothing else of its body any more.
bool PieceFinder::releases(const CutMesh& mesh, int removed) const {
  const int body = body_of_[static_cast<std::size_t>(removed)];
  const auto holds = [&](int t) { return mesh.remains(t) && body_of_[static_cast<std::size_t>(t)] == body; };
  return std::ranges::any_of(mesh.mesh().tetrahedra[static_cast<std::size_t>(removed)], [&](int v) {
    return held_[static_cast<std::size_t>(v)] != 0 && std::ranges::none_of(mesh.around(v), holds);
  });
}

std::vector<Piece> PieceFinder::separated(const CutMesh& mesh, std::span<const int> tetrahedra) {
  return cut_off_by(mesh, tetrahedra, [&](std::span<const int> of_body) { return fronts_at(of_body); });
}

std::vector<std::vector<int>> PieceFinder::floating(const CutMesh& mesh) const {
  DisjointSets sets(body_held_.size());  // of bodies that share a vertex
  std::vector<int> loose;
  for (int t = 0; t < static_cast<int>(body_of_.size()); ++t) {
    if (mesh.remains(t) && body_held_[static_cast<std::size_t>(body_of_[static_cast<std::size_t>(t)])] == 0)
      loose.push_back(t);
  }
  for (const int t : loose) {
    for (const int v : mesh.mesh().tetrahedra[static_cast<std::size_t>(t)]) {
      for (const int other : mesh.around(v)) {
        if (mesh.remains(other))
          sets.join(body_of_[static_cast<std::size_t>(t)], body_of_[static_cast<std::size_t>(other)]);
      }
    }
  }
  std::vector<char> held(body_held_.size(), 0);  // of sets
  for (int body = 0; body < static_cast<int>(body_held_.size()); ++body)
    held[static_cast<std::size_t>(sets.of(body))] |= body_held_[static_cast<std::size_t>(body)];
  std::map<int, std::vector<int>> parts;  // of each set
  for (const int t : loose) {
    const int set = sets.of(body_of_[static_cast<std::size_t>(t)]);
    if (held[static_cast<std::size_t>(set)] == 0) parts[set].push_back(t);
  }
  std::vector<std::vector<int>> floating;
  for (auto& [set, tetrahedra] : parts) floating.push_back(std::move(tetrahedra));
  return floating;
}

/// Makes what is cut off a body of its own from now on.
void PieceFinder::name_bodies(std::vector<Piece>& pieces) {
  for (const Piece& piece : pieces) {
    for (const int t : piece.tetrahedra)
      body_of_[static_cast<std::size_t>(t)] = static_cast<int>(body_held_.size());
    body_held_.push_back(piece.held ? 1 : 0);
    released_.push_back(0);
  }
}

std::vector<Piece> PieceFinder::cut_off_body(const CutMesh& mesh, std::vector<Front> fronts, int body) {
  DisjointSets sets(fronts.size());
  const int rest = grow_until_separate(mesh, fronts, sets);
  std::map<int, Front> entire;  // of each set
  for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
    std::vector<int>& reached = entire[sets.of(f)].reached;
    reached.insert(reached.end(), fronts[static_cast<std::size_t>(f)].reached.begin(),
                   fronts[static_cast<std::size_t>(f)].reached.end());
  }
  std::vector<Piece> pieces;
  for (const auto& [set, front] : entire) {
    if (set != rest) pieces.push_back(piece_of(mesh, front.reached));
  }
  // What was not followed is what holds the body, unless something else is held, nothing is, or it was let
  // go of.
  char& body_held = body_held_[static_cast<std::size_t>(body)];
  const bool release = std::exchange(released_[static_cast<std::size_t>(body)], 0) != 0 && body_held != 0;
  const bool all_known = rest < 0 || body_held == 0 || release || std::ranges::any_of(pieces, &Piece::held);
  if (rest >= 0 && all_known) {
    Front& front = entire[rest];
    while (front.next < front.reached.size()) grow(mesh, front, rest);
    pieces.push_back(piece_of(mesh, front.reached));
  }
  if (all_known && !pieces.empty()) {
    const auto stays = piece_that_stays(pieces);
    body_held = stays->held ? 1 : 0;
    if (stays->held || !release) pieces.erase(stays);
  }
  for (const auto& [set, front] : entire) {
    for (const int t : front.reached) front_of_[static_cast<std::size_t>(t)] = -1;
  }
  return pieces;
}

}  // namespace palpate::sim
