#pragma once
#include <optional>

#include "sim_server/cutting/cautery.h"
#include "sim_server/cutting/scalpel.h"
#include "sim_server/mesh/pieces.h"
#include "sim_server/tissue/deformation_model.h"

namespace palpate::sim {

/// Totals of a resection so far. Volumes and areas are those at rest.
struct ResectionTotals {
  std::uint64_t tetrahedra = 0;               ///< gone, with those of pieces
  double volume = 0;                          ///< of these, m^3
  double dropped_volume = 0;                  ///< of loose pieces that went, within `volume`, m^3
  int dropped_pieces = 0, loose_pieces = 0;   ///< that went; that stay, held by nothing
  double loose_volume = 0;                    ///< of those that stay, when they came loose, m^3
  double cut_area = 0;                        ///< surface that was inside at first, m^2: both sides
  double distance_sum = 0, furthest = 0;      ///< from the plan: m x m^3 of what is gone; m
  double heat = 0, elastic = 0, kinetic = 0;  ///< J: put in by tips; that went with the tissue
  Vec3 momentum = Vec3::Zero();               ///< N s, the same
  double separated_area = 0;                  ///< by blades, m^2: one side
  double separated_distance_sum = 0;          ///< of that from the plan, m x m^2
  std::uint64_t slides = 0, splits = 0;       ///< of vertices, by blades
  std::uint64_t outrun_steps = 0;  ///< flagged: a blade had gone farther in a step than its edge is long
  bool ran_out = false;            ///< of vertices: a blade has parted less than it went through
  double hot_time = 0, contact_time = 0;  ///< s with a tip hot; and that touched
  double time_at_end = 0;  ///< s, of each tool: cuts, at tissue that cannot be removed or parted

  /// Returns the mean distance of parted faces from the plan, m; 0 where nothing is parted.
  double mean_separated_distance() const {
    return separated_area > 0 ? separated_distance_sum / separated_area : 0;
  }
  /// Returns the mean distance of tissue removed by heat from the plan, m; 0 where none is removed.
  double mean_distance() const {
    const double cut = volume - dropped_volume;
    return cut > 0 ? distance_sum / cut : 0;
  }
};

/// Faces and area that a blade parted.
struct Separated {
  Stroke stroke;
  Parting parting;
  double area = 0;  ///< m^2, one side
};

/// Remaining tissue of an organ that is cut. One thread; allocates.
class Resection {
 public:
  /// Gives `surface` the vertices of all that can be cut (`CutMesh`). `held`: mesh vertices that are fixed,
  /// ascending. The mesh outlives this. Throws `Error` as `removable_tetrahedra`.
  /// `parts`: by blades, too; the mesh then gets spare vertices, as `CutMesh` says.
  Resection(const Cutting& cutting, TetMesh& mesh, std::span<const int> held, Surface& surface, bool parts);

  /// Starts a new step.
  void start_step() { changed_ = false; }
  /// `dt` (s) of these hot tips, on the surface at `positions`. What is gone then, in the order in which it
  /// went: what heat removed, then pieces that it cut off. Changes `surface`.
  std::span<const int> advance(std::span<const HotTip> tips, std::span<const Vec3> positions, double dt,
                               Surface& surface);
  /// Removes these that are left, and what they cut off, as if by heat.
  std::span<const int> remove(std::span<const int> tetrahedra, Surface& surface);

  /// Returns the tetrahedra that the last removal was asked to remove, without the pieces that it cut off.
  std::span<const int> requested() const { return std::span(removed_).first(requested_); }

  /// Parts tissue along the path of a blade, as `Scalpel::cut`, of a resection that `parts`. The pieces that
  /// it cut off and that go are `removed` then.
  const Separated& part(const BladeSweep& blade, std::span<Vec3> were, std::span<Vec3> are, Surface& surface);
  std::span<const int> removed() const { return removed_; }
  /// Returns the tetrahedra of each part that floats, as `PieceFinder::floating`. O(m).
  std::vector<std::vector<int>> floating() const { return pieces_.floating(remaining_); }
  /// Sets the mesh vertices that do not slide onto the path of a blade, beside those that have slid.
  void keep(std::vector<int> vertices) { scalpel_->keep(std::move(vertices)); }
  /// The way over which a blade does the work of what it parts, m.
  double blade_size() const { return scalpel_->size(); }

  const CutMesh& remaining() const { return remaining_; }
  /// Returns the number of steps with a cut so far, which identifies the surface.
  std::uint32_t version() const { return version_; }
  bool has_plan() const { return plan_.has_value(); }
  const ResectionTotals& totals() const { return totals_; }
  /// Returns the totals, for entries that only the owner knows.
  ResectionTotals& totals() { return totals_; }
  std::size_t bytes() const;
  /// Returns an estimate of `bytes`, for a mesh with so many vertices, tetrahedra and outer faces that can
  /// all be removed.
  static double estimated_bytes(double vertices, double tetrahedra, double faces);

 private:
  void note_change();
  void take_out(std::span<const int> tetrahedra, Surface& surface);
  void judge(std::span<const Piece> pieces, Surface& surface);

  std::optional<CutPlan> plan_;
  double smallest_piece_;  // m^3
  CutMesh remaining_;
  PieceFinder pieces_;
  Cautery cautery_;
  std::optional<Scalpel> scalpel_;
  Separated separated_;
  std::vector<int> removed_;
  std::size_t requested_ = 0;
  std::uint32_t version_ = 0;
  bool changed_ = false;  // in this step
  ResectionTotals totals_;
};

}  // namespace palpate::sim
