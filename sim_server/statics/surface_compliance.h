#pragma once
#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim_server/low_rank/block_low_rank_matrix.h"
#include "sim_server/low_rank/point_tiles.h"
#include "sim_server/sparse/factored_matrix.h"
#include "sim_server/statics/compliance_tolerance.h"
#include "sim_server/tissue/deformation_model.h"
#include "sim_server/tissue/model_inputs.h"

namespace palpate::sim {

/// Throws `Error` where a scene has no [material], or nothing that holds its body.
void require_held_tissue(const ModelInputs& inputs);

/// The free surface vertices that tools reach, in the order of the rows of W: in its tiles, or all in one
/// where W is dense.
PointTiles compliant_vertices(const ModelInputs& inputs);

/// Compliance of a linear tissue where tools can reach it: W (3r x 3r, m/N, symmetric), the displacement of
/// each of the r free reachable surface vertices per force on each. Dense, 27 MB for 614 of them, or of many
/// in tiles of low rank. A surface vertex out of reach does not give way; it is not computed. A fixed one
/// does not move with the tissue, but where the tool presses on it, it gives way as `held_stiffness` says.
class SurfaceCompliance final : public ComplianceSource {
 public:
  /// Numbers the rows; W is not there yet. Throws `Error` without material or fixed nodes, where all
  /// reachable vertices are fixed, or where W would take more than 4 GB, or than there are free: of tiles, as
  /// far as that is known beforehand.
  explicit SurfaceCompliance(const ModelInputs& inputs);

  /// Set-up: W is the rows and columns `unknowns` of an inverse, three for each of `vertices`. On all cores;
  /// the same bytes on any number of them. Throws `Error` where there is no room for it.
  void compute(const FactoredMatrix& inverse_of, std::span<const int> unknowns, const Progress& progress);
  /// Fills columns `first`, `first` + 1, ... of W: where all rows go (m) per force on these. Called by
  /// several threads at once.
  using Respond = std::function<void(Eigen::Index first, Eigen::Ref<Eigen::MatrixXd> columns)>;
  /// Computes W by calls for at most `at_once` columns each; tells `progress` from the calling thread, after
  /// so many calls (16 at most; fewer where a call takes long).
  void compute(std::size_t at_once, const Respond& respond, const Progress& progress,
               std::size_t calls_per_report = 16);

  /// Takes W from where it was kept, the `source` of which reports tell. False where it is not of this size:
  /// then nothing is changed.
  bool take(MappedMatrix&& stored, std::string_view source);
  /// Passes W to `keep`, as `take` wants it: tiles as a copy. Throws `Error` where there is no room for that.
  void pass_to(const std::function<void(const Eigen::Ref<const Eigen::MatrixXd>&)>& keep) const;
  /// "1934 nodes, from the set-up cache, which saved 3.2 s".
  std::string detail() const;
  /// W has been put there.
  void was_stored_in(std::string_view where) { note_ = "now in " + std::string(where); }

  /// Adds sum_k weights_k s_k s_k^T, s_k: shape k over the rows. `shapes`: (3 surface vertices x k). Set-up,
  /// on all cores, once.
  void add(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& weights);

  /// Surface vertices of the rows, three rows each.
  const std::vector<int>& vertices() const { return rows_.order; }
  /// The tolerance of W in tiles; 0: it is dense.
  double tolerance() const { return tolerance_; }
  /// Returns the first rows of its tiles, as rows of `vertices`.
  const std::vector<int>& tile_begins() const { return rows_.begins; }
  /// First row of a surface vertex, or -1: fixed or out of reach.
  int row(int vertex) const { return row_[vertex]; }

  /// Fills the compliance as `DeformationModel::compliance`.
  void fill(std::span<const int> vertices, ContactPatch& patch) const noexcept;
  void begin(ContactPatch& patch) const noexcept override;
  void fill(int node, ContactPatch& patch) const noexcept override;
  /// True if the tissue yields at a surface vertex: it is free, and a tool can reach it.
  bool yields(int vertex) const noexcept { return row_[vertex] >= 0; }
  /// Returns the compliance (m/N) of the surface that bears these loads, as one piece. O(loads^2).
  Mat3 of_loads(std::span<const VertexLoad> loads) const noexcept;
  /// Moves `positions` (surface vertices, m) by what `loads` do. O(r x loads); in tiles, O(r x rank x loaded
  /// tiles).
  void move(std::span<const VertexLoad> loads, std::span<Vec3> positions) noexcept;

  /// Returns the memory of W and of the numbers of its rows, bytes.
  std::size_t bytes() const;
  std::size_t index_bytes() const {
    return (row_.size() + vertices().size()) * sizeof(int) + loads_.capacity() * sizeof(VertexLoad);
  }

 private:
  Eigen::Index size() const { return 3 * static_cast<Eigen::Index>(vertices().size()); }  // of W
  void allocate();
  Mat3 block(int vertex, int other) const noexcept;
  void require_room(double bytes, double free) const;
  void compute_tiles(std::size_t at_once, std::size_t report, const Respond& respond,
                     const Progress& progress);

  std::string source_;    // of the scene, for errors
  double tolerance_ = 0;  // 0: W is dense
  double expected_bytes_ = 0;
  PointTiles rows_;       // of surface vertices
  std::vector<int> row_;  // per surface vertex
  // W: one of the three.
  Eigen::MatrixXd computed_;
  std::optional<MappedMatrix> stored_;
  std::optional<BlockLowRankMatrix> tiles_;
  Eigen::Map<Eigen::MatrixXd> compliance_{nullptr, 0, 0};  // the dense one
  std::string note_;
  double held_compliance_;         // m/N, of a fixed vertex under the tool itself
  Eigen::VectorXd moved_;          // (3r) what the loads of a `move` do, m
  std::vector<VertexLoad> loads_;  // of a `move`, on tiles
};

}  // namespace palpate::sim
