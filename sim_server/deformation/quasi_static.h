#pragma once
#include "sim_server/deformation/deformation_models.h"

namespace palpate::sim {

/// Linear elastic equilibrium K u = f at every step (Cotin, Delingette and Ayache 1999, IEEE TVCG 5:62:
/// pre-computed elementary deformations). Set-up factors K over the free nodes and keeps W = J K^-1 J^T for
/// the r reachable surface nodes: (3r x 3r) doubles, 27 MB for 614 of them. A step then is a few
/// columns of W: O(r x loaded nodes). Surface nodes out of reach are kept at rest; they are not computed.
/// A fixed vertex does not move with the tissue, but where the tool presses on it, it gives way like the
/// stiffest free vertex: an infinitely hard wall in soft tissue would be neither true nor safe.
class QuasiStatic : public DeformationModel {
 public:
  /// Throws `Error` without material or fixed nodes, or when K is singular.
  explicit QuasiStatic(const ModelInputs& inputs);
  std::span<const Vec3> free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  bool compliance_is_constant() const noexcept override { return true; }
  std::span<const Vec3> apply(std::span<const NodalLoad> loads) noexcept override;
  std::vector<MemoryPart> memory() const override;

 private:
  void precompute(const ModelInputs& inputs);

  std::vector<Vec3> rest_, positions_;
  std::vector<int> row_;  // per surface vertex: its first row in compliance_, or -1 (fixed or out of reach)
  std::vector<int> reachable_;  // surface vertex of each block row
  double held_compliance_ = 0;  // m/N, of a fixed vertex under the tool itself: that of the stiffest free one
  Eigen::MatrixXd compliance_;  // m/N
};

}  // namespace palpate::sim
