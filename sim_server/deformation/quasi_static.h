#pragma once
#include "sim_server/deformation/estimated_memory.h"
#include "sim_server/deformation/moving_supports.h"
#include "sim_server/deformation/surface_compliance.h"

namespace palpate::sim {

/// Linear elastic equilibrium K u = f at every step (Cotin, Delingette and Ayache 1999, IEEE TVCG 5:62:
/// pre-computed elementary deformations). Set-up factors K over the free nodes and keeps W = J K^-1 J^T for
/// the reachable surface nodes (`SurfaceCompliance`). A step then is a few columns of W. Where supports move,
/// the free shape moves by the static response to them (`support_responses`). Any element and fibres, of the
/// linear law; vertices are what tools press on, also where there are nodes between them.
class QuasiStatic : public DeformationModel {
 public:
  /// Throws `Error` as `SurfaceCompliance`, or when K is singular.
  explicit QuasiStatic(const ModelInputs& inputs);
  /// Before anything is allocated.
  static double estimated_bytes(const Scene& scene, const MeshCounts& counts);
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  const ComplianceSource* compliance_source() const noexcept override { return &compliance_; }
  bool compliance_is_constant() const noexcept override { return true; }
  std::span<const Vec3> apply(std::span<const NodalLoad> loads) noexcept override;
  std::vector<MemoryPart> memory() const override;

 private:
  /// The last two answers: a tool that looks ahead goes back to where it was with the loads that it had
  /// there.
  struct Answer {
    std::vector<NodalLoad> loads;
    std::vector<Vec3> positions;
    bool stands = false;  // false: the supports have moved since
  };
  std::vector<Vec3> rest_;
  Answer answer_, before_;
  SurfaceCompliance compliance_;
  std::optional<MovingSupports> supports_;  // where some move
};

}  // namespace palpate::sim
