#pragma once
#include <optional>

#include "sim_server/explicit/condensed_part.h"
#include "sim_server/explicit/explicit_motion.h"

namespace palpate::sim {

/// A linear elastic body of which vertices are in motion by explicit steps, with a tensor per vertex and edge
/// (`ElasticTensors`), and the rest, if any, is condensed: what it is, and where it is by now. It stays where
/// it was made.
struct CuttableBody {
  /// `mass_factors`: of tetrahedra. `moves`: of each mesh vertex, not 0 where it is in motion; null: all are.
  /// Throws `Error` as `CondensedPart`.
  CuttableBody(const ModelInputs& inputs, const std::vector<double>& mass_factors,
               const std::vector<char>* moves, const CondensedPart::Modes& modes);
  CuttableBody(const CuttableBody&) = delete;
  CuttableBody& operator=(const CuttableBody&) = delete;

  ElasticTensors tensors;
  std::optional<CondensedPart> rest;
  ExplicitMotion motion;
  std::vector<int> first;  ///< per surface vertex: its first number in `motion`, or -1

  /// Removes these tetrahedra, and the condensed parts that have any of them. A vertex without any remaining
  /// tetrahedron stops. O(removed). Returns energy and momentum of those parts.
  CuttableModel::Removed remove(std::span<const int> tetrahedra, const CutMesh& remaining,
                                const Material& material);

  /// Slides and parts as `DeformationModel::part`. Where that makes an element so stiff that it would have a
  /// higher frequency (rad/s) alone, its mass grows.
  void part(std::span<const CuttableModel::Slide> slides, const Parting& parting, const CutMesh& remaining,
            const Material& material, double frequency);

  /// Lets these parts of the body float (their tetrahedra, as `CuttableModel::release`), with the condensed
  /// parts that they have.
  void release(std::span<const std::vector<int>> floating, const TetMesh& mesh);

  /// Finds the forces of the condensed part on the border where both are by now, `force` (N, 3 x places).
  /// `changed`: since the last sub-step, by anything but impulses. Of a body with a condensed part.
  void pull_border(bool changed, std::span<double> force) noexcept;
  /// Takes where the border is by now, for the surface of the condensed part. Of such a body.
  void place_rest() noexcept;

  /// Since a body was made of a mesh, these vertices of that slid and faces were parted, in any order;
  /// `remaining` is now. The copies are where what they are of is.
  void reshape(std::span<const int> slid, const Parting& parting, const CutMesh& remaining,
               const Material& material, double frequency);
};

}  // namespace palpate::sim
