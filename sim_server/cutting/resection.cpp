#include "sim_server/cutting/resection.h"

#include <algorithm>

namespace palpate::sim {

Resection::Resection(const Cutting& cutting, TetMesh& mesh, std::span<const int> held, Surface& surface,
                     bool parts)
    : plan_(cutting.plan),
      smallest_piece_(cutting.smallest_piece),
      remaining_(parts ? CutMesh(mesh, removable_tetrahedra(cutting, mesh), surface, held)
                       : CutMesh(mesh, removable_tetrahedra(cutting, mesh), surface)),
      pieces_(remaining_, held),
      cautery_(cutting, mesh) {
  if (parts) scalpel_.emplace(remaining_);
}

std::span<const int> Resection::advance(std::span<const HotTip> tips, std::span<const Vec3> positions,
                                        double dt, Surface& surface) {
  removed_.clear();
  requested_ = 0;
  if (tips.empty()) return removed_;
  const double at_end = cautery_.time_at_end();
  const std::vector<int> removed = cautery_.heat(tips, remaining_, surface, positions, dt);
  totals_.heat = cautery_.spent();
  totals_.time_at_end += cautery_.time_at_end() - at_end;
  totals_.hot_time += dt;
  return remove(removed, surface);
}

std::span<const int> Resection::remove(std::span<const int> tetrahedra, Surface& surface) {
  removed_.clear();
  requested_ = tetrahedra.size();
  if (tetrahedra.empty()) return removed_;
  note_change();
  take_out(tetrahedra, surface);
  if (plan_) {
    for (const int t : tetrahedra) {
      const Tetrahedron& corners = remaining_.mesh().tetrahedra[static_cast<std::size_t>(t)];
      const double away = std::abs(plan_->distance(centre_of(remaining_.mesh(), corners)));
      totals_.distance_sum += away * six_volumes(remaining_.mesh(), corners) / 6;
      totals_.furthest = std::max(totals_.furthest, away);
    }
  }
  judge(pieces_.cut_off(remaining_, tetrahedra), surface);
  return removed_;
}

void Resection::note_change() {
  version_ += changed_ ? 0 : 1;
  changed_ = true;
}

/// Removes or keeps what has come loose.
void Resection::judge(std::span<const Piece> pieces, Surface& surface) {
  for (const Piece& piece : pieces) {
    if (piece.held) continue;
    if (piece.volume >= smallest_piece_) {
      ++totals_.loose_pieces;
      totals_.loose_volume += piece.volume;
      continue;
    }
    ++totals_.dropped_pieces;
    totals_.dropped_volume += piece.volume;
    take_out(piece.tetrahedra, surface);
  }
}

const Separated& Resection::part(const BladeSweep& blade, std::span<Vec3> were, std::span<Vec3> are,
                                 Surface& surface) {
  removed_.clear();
  requested_ = 0;
  separated_ = {};
  separated_.stroke = scalpel_->cut(blade, were, are, remaining_);
  totals_.slides += separated_.stroke.slides.size();
  if (separated_.stroke.faces.empty()) return separated_;
  note_change();
  const double before = remaining_.cut_area();
  separated_.parting = remaining_.part(separated_.stroke.faces, surface);
  separated_.area = 0.5 * (remaining_.cut_area() - before);
  totals_.separated_area += separated_.area;
  totals_.cut_area = remaining_.cut_area();
  totals_.splits += separated_.parting.splits.size();
  for (const int face : plan_ ? separated_.stroke.faces : std::vector<int>()) {
    const double away = std::abs(plan_->distance(remaining_.centre_of_face(face)));
    totals_.separated_distance_sum += remaining_.area_of(face) * away;
    totals_.furthest = std::max(totals_.furthest, away);
  }
  totals_.ran_out = totals_.ran_out || separated_.parting.ran_out;
  judge(pieces_.separated(remaining_, separated_.parting.tetrahedra), surface);
  return separated_;
}

void Resection::take_out(std::span<const int> tetrahedra, Surface& surface) {
  const TetMesh& mesh = remaining_.mesh();
  remaining_.remove(tetrahedra, surface);
  totals_.cut_area = remaining_.cut_area();
  totals_.tetrahedra += tetrahedra.size();
  for (const int t : tetrahedra)
    totals_.volume += six_volumes(mesh, mesh.tetrahedra[static_cast<std::size_t>(t)]) / 6;
  removed_.insert(removed_.end(), tetrahedra.begin(), tetrahedra.end());
}

double Resection::estimated_bytes(double vertices, double tetrahedra, double faces) {
  constexpr double kNumbers = 4 + 4 + 4 + 2;  // neighbours, around, places of faces, bodies, fronts
  return tetrahedra * (kNumbers * sizeof(int) + 6 + 2 * sizeof(double)) + vertices * (4 * sizeof(int) + 1) +
         sizeof(int) + faces * sizeof(int);
}

std::size_t Resection::bytes() const {
  const std::size_t tetrahedra = remaining_.mesh().tetrahedra.size();
  return remaining_.bytes() + cautery_.bytes() + 2 * tetrahedra * sizeof(int) +
         remaining_.mesh().vertices.size();
}

}  // namespace palpate::sim
