#include "sim_server/cutting/resection.h"

#include <algorithm>

namespace palpate::sim {

Resection::Resection(const Cutting& cutting, TetMesh& mesh, std::span<const int> held, Surface& surface,
                     bool parts)
    : plan_(cutting.plan),
      smallest_piece_(cutting.smallest_piece),
      left_(parts ? CutMesh(mesh, removable_tetrahedra(cutting, mesh), surface, held)
                  : CutMesh(mesh, removable_tetrahedra(cutting, mesh), surface)),
      pieces_(left_, held),
      cautery_(cutting, mesh) {
  if (parts) scalpel_.emplace(left_);
}

std::span<const int> Resection::advance(std::span<const HotTip> tips, std::span<const Vec3> positions,
                                        double dt, Surface& surface) {
  removed_.clear();
  asked_for_ = 0;
  if (tips.empty()) return removed_;
  const double at_end = cautery_.time_at_end();
  const std::vector<int> gone = cautery_.heat(tips, left_, surface, positions, dt);
  totals_.heat = cautery_.spent();
  totals_.time_at_end += cautery_.time_at_end() - at_end;
  totals_.hot_time += dt;
  return remove(gone, surface);
}

std::span<const int> Resection::remove(std::span<const int> tetrahedra, Surface& surface) {
  removed_.clear();
  asked_for_ = tetrahedra.size();
  if (tetrahedra.empty()) return removed_;
  note_change();
  take_out(tetrahedra, surface);
  if (plan_) {
    for (const int t : tetrahedra) {
      const Tetrahedron& corners = left_.mesh().tetrahedra[static_cast<std::size_t>(t)];
      const double away = std::abs(plan_->distance(centre_of(left_.mesh(), corners)));
      totals_.distance_sum += away * six_volumes(left_.mesh(), corners) / 6;
      totals_.farthest = std::max(totals_.farthest, away);
    }
  }
  judge(pieces_.cut_off(left_, tetrahedra), surface);
  return removed_;
}

void Resection::note_change() {
  version_ += changed_ ? 0 : 1;
  changed_ = true;
}

/// What has come loose goes, or stays.
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

const Parted& Resection::part(const BladeSweep& blade, std::span<Vec3> were, std::span<Vec3> are,
                              Surface& surface) {
  removed_.clear();
  asked_for_ = 0;
  parted_ = {};
  parted_.stroke = scalpel_->cut(blade, were, are, left_);
  totals_.slides += parted_.stroke.slides.size();
  if (parted_.stroke.faces.empty()) return parted_;
  note_change();
  const double before = left_.cut_area();
  parted_.parting = left_.part(parted_.stroke.faces, surface);
  parted_.area = 0.5 * (left_.cut_area() - before);
  totals_.parted_area += parted_.area;
  totals_.cut_area = left_.cut_area();
  totals_.splits += parted_.parting.splits.size();
  for (const int face : plan_ ? parted_.stroke.faces : std::vector<int>()) {
    const double away = std::abs(plan_->distance(left_.centre_of_face(face)));
    totals_.parted_distance_sum += left_.area_of(face) * away;
    totals_.farthest = std::max(totals_.farthest, away);
  }
  totals_.ran_out = totals_.ran_out || parted_.parting.ran_out;
  judge(pieces_.parted(left_, parted_.parting.tetrahedra), surface);
  return parted_;
}

void Resection::take_out(std::span<const int> tetrahedra, Surface& surface) {
  const TetMesh& mesh = left_.mesh();
  left_.remove(tetrahedra, surface);
  totals_.cut_area = left_.cut_area();
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
  const std::size_t tetrahedra = left_.mesh().tetrahedra.size();
  return left_.bytes() + cautery_.bytes() + 2 * tetrahedra * sizeof(int) + left_.mesh().vertices.size();
}

}  // namespace palpate::sim
