#pragma once
#include <optional>

#include "sim_server/deformation/condensed_rest.h"
#include "sim_server/deformation/explicit_motion.h"

namespace palpate::sim {

/// Of `fixed`, which has all spare vertices of a mesh that can be parted, those that stand by now: the spares
/// that became a copy of another vertex are in motion, with a place there. Ascending where `fixed` is.
std::vector<int> fixed_by_now(std::span<const int> fixed, std::span<const int> places);

/// A linear elastic body of which vertices are in motion by explicit steps, with a tensor per vertex and edge
/// (`ElasticTensors`), and the rest, if any, is condensed: what it is, and where it is by now. It stays where
/// it was made.
struct CuttableBody {
  /// `mass_factors`: of tetrahedra. `moves`: of each mesh vertex, not 0 where it is in motion; null: all are.
  /// Throws `Error` as `CondensedRest`.
  CuttableBody(const ModelInputs& inputs, const std::vector<double>& mass_factors,
               const std::vector<char>* moves, const CondensedRest::Modes& modes);
  CuttableBody(const CuttableBody&) = delete;
  CuttableBody& operator=(const CuttableBody&) = delete;

  ElasticTensors tensors;
  std::optional<CondensedRest> rest;
  ExplicitMotion motion;
  std::vector<int> first;  ///< per surface vertex: its first number in `motion`, or -1

  /// These tetrahedra are no more, `left` are: neither are parts of the rest that had any of them. What is
  /// left of no tetrahedron stands. O(removed). Returns what went with those parts.
  DeformationModel::Removed remove(std::span<const int> tetrahedra, const CutMesh& left,
                                   const Material& material);

  /// Slides and parts as `DeformationModel::part`. Where that makes an element so stiff that it would have a
  /// higher frequency (rad/s) alone, its mass grows.
  void part(std::span<const DeformationModel::Slide> slides, const Parting& parting, const CutMesh& left,
            const Material& material, double frequency);

  /// Since a body was made of a mesh, these vertices of that slid and faces were parted, in any order; `left`
  /// is now. The copies are where what they are of is.
  void reshape(std::span<const int> slid, const Parting& parting, const CutMesh& left,
               const Material& material, double frequency);

  /// The forces on what is in motion, N, where that stands at `x` (m; both 3 x vertices in motion) and the
  /// rest is at rest, under these loads. Moves the modes of the rest to where they balance. O(edges + b^2).
  void static_force(const std::vector<double>& x, std::span<const NodalLoad> loads,
                    std::vector<double>& force) noexcept;
};

}  // namespace palpate::sim
