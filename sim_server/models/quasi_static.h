#pragma once
#include "sim_server/statics/moving_supports.h"
#include "sim_server/statics/surface_compliance.h"
#include "sim_server/tissue/estimated_memory.h"

namespace palpate::sim {

/// Linear elastic equilibrium K u = f at every step (Cotin, Delingette and Ayache 1999, IEEE TVCG 5:62:
/// pre-computed elementary deformations). Set-up factors K over the free nodes and keeps W = J K^-1 J^T for
/// the reachable surface nodes (`SurfaceCompliance`). A step then is a few columns of W. Where supports move,
/// the free shape moves by the static response to them (`support_responses`). Any element and fibres, of the
/// linear law; vertices are what tools press on, also where there are nodes between them.
class QuasiStatic final : public DeformationModel, public StatefulModel {
 public:
  /// Throws `Error` as `SurfaceCompliance`, or when K is singular.
  explicit QuasiStatic(const ModelInputs& inputs);
  /// Before anything is allocated.
  static double estimated_bytes(const Scene& scene, const MeshCounts& counts);
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::span<const Vec3> apply(std::span<const VertexLoad> loads) noexcept override;
  ModelTraits traits() noexcept override {
    return {.constant_compliance = true, .columns = &compliance_, .state = this};
  }
  std::vector<MemoryPart> memory() const override;
  std::any save() override;
  FreeMotion restore(const std::any& state) override;

 private:
  /// Answer to the last loads, or to those before: a tool that is probed ahead returns to its place with its
  /// loads there.
  struct Answer {
    std::vector<VertexLoad> loads;
    std::vector<Vec3> positions;
    bool valid = false;  // false: the supports have moved since
  };
  struct State {
    Answer answer, before;
    std::optional<MovingSupports::State> supports;
  };
  std::vector<Vec3> rest_;
  Answer answer_, before_;
  SurfaceCompliance compliance_;
  std::optional<MovingSupports> supports_;  // where some move
};

}  // namespace palpate::sim
