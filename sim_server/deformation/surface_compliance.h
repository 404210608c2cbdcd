#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "sim_server/deformation/deformation_model.h"
#include "sim_server/deformation/model_inputs.h"

namespace palpate::sim {

/// How compliant a linear tissue is where tools can reach it: W (3r x 3r, m/N, symmetric), the displacement
/// of each of the r free reachable surface vertices per force on each. 27 MB for 614 of them. A surface
/// vertex out of reach does not give way; it is not computed. A fixed one does not move with the tissue, but
/// where the tool presses on it, it gives way as `held_stiffness` says.
class SurfaceCompliance {
 public:
  /// Numbers the rows; W is not there yet. Throws `Error` without material or fixed nodes, where all
  /// reachable vertices are fixed, or where W would take more than 4 GB, or than there are free.
  explicit SurfaceCompliance(const ModelInputs& inputs);

  /// Fills columns `first`, `first` + 1, ... of W: where all rows go (m) per force on these. Called by
  /// several threads at once.
  using Respond = std::function<void(Eigen::Index first, Eigen::Ref<Eigen::MatrixXd> columns)>;
  /// Set-up: asks for W, `at_once` columns with one call, on all cores; the same bytes on any number of them.
  /// Allocates W, and throws `Error` where what was built meanwhile left no room for it; tells `progress`
  /// from the calling thread, after so many calls (16 at most; fewer where a call takes long).
  void compute(std::size_t at_once, const Respond& respond, const Progress& progress,
               std::size_t calls_per_report = 16);

  /// Adds sum_k weights_k s_k s_k^T, s_k: shape k over the rows. `shapes`: (3 surface vertices x k). Set-up,
  /// on all cores.
  void add(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& weights);

  /// Surface vertices of the rows, three rows each.
  const std::vector<int>& vertices() const { return vertices_; }
  /// First row of a surface vertex, or -1: fixed or out of reach.
  int row(int vertex) const { return row_[vertex]; }

  /// As `DeformationModel::compliance`.
  void fill(std::span<const int> vertices, ContactPatch& patch) const noexcept;
  /// Moves `positions` (surface vertices, m) by what `loads` do. O(r x loads).
  void move(std::span<const NodalLoad> loads, std::span<Vec3> positions) const noexcept;

  /// Of W, and of the numbers of its rows.
  std::size_t bytes() const { return static_cast<std::size_t>(compliance_.size()) * sizeof(double); }
  std::size_t index_bytes() const { return (row_.size() + vertices_.size()) * sizeof(int); }

 private:
  void require_room(double free) const;

  std::string source_;          // of the scene, for errors
  std::vector<int> row_;        // per surface vertex
  std::vector<int> vertices_;   // surface vertex of each block row
  Eigen::MatrixXd compliance_;  // W
  double held_compliance_;      // m/N, of a fixed vertex under the tool itself
};

}  // namespace palpate::sim
