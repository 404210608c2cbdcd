#pragma once
#include <memory>

#include "sim_server/client_model/published_motion.h"
#include "sim_server/explicit/explicit_motion.h"
#include "sim_server/statics/moving_supports.h"
#include "sim_server/statics/surface_compliance.h"
#include "sim_server/tissue/contact_instants.h"
#include "sim_server/tissue/estimated_memory.h"

namespace palpate::sim {

/// Linear elastic tissue in motion: explicit dynamics with a tensor per vertex and per edge (Cotin,
/// Delingette and Ayache 2000, Vis. Comput. 16:437), lumped masses and Rayleigh damping (`ExplicitMotion`).
/// Its time goes in periods T from one instant of contact to the next, each of N sub-steps as long as the
/// measured highest frequency allows. Loads are held over a period, so that one compliance serves the contact
/// solver and the clients: R, the displacement at the end of a period per force held over it, the same at
/// every step. Set-up finds it by running N sub-steps from rest under unit loads, eight at once
/// (`SurfaceCompliance`). Where a period is a few sub-steps, what a load stops at its end would swing back in
/// the next: its velocity along the load becomes what it went by on average, if that is less (the velocity
/// stage of RATTLE, Andersen 1983, J. Comput. Phys. 52:24). A period costs N sub-steps, twice that in
/// contact where N is not 1. What the body does by itself and what it does by its supports add up, as it is
/// linear: where supports move, the second comes from `support_responses`, with inertia and damping and exact
/// in time, and costs no sub-step anything. Its slow modes are published (`PublishedMotion`), for which
/// set-up factors K. Tissue that can be cut moves as `CuttableMotion` says.
class TensorMass final : public DeformationModel,
                         public ClientModel,
                         public LaterCompliance,
                         public InteriorView,
                         public StatefulModel {
 public:
  /// Throws `Error` as `SurfaceCompliance`, or where the scene names no rate.
  explicit TensorMass(const ModelInputs& inputs);
  /// The model of a scene: this one, or `CuttableMotion` where it has [cutting].
  static std::unique_ptr<DeformationModel> make(const ModelInputs& inputs);
  /// Before anything is allocated.
  static double estimated_bytes(const Scene& scene, const MeshCounts& counts);
  /// Any `dt` > 0 is taken for one period: callers step at the scene's rate, though their times may jitter
  /// about it. The loads of the last `apply` are those of the period that ends; the next runs free of any.
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::span<const Vec3> apply(std::span<const VertexLoad> loads) noexcept override;
  Mat3 later_compliance(std::span<const VertexLoad> loads, double seconds) const noexcept override;
  const PublishedModes* modes() const noexcept override { return &published_->modes(); }
  void read_modes(ModalMotion& state) noexcept override;
  void residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  /// Returns the positions at the beginning of the period.
  std::span<const Vec3> nodes() const noexcept override;
  ModelTraits traits() noexcept override;
  std::vector<MemoryPart> memory() const override;
  std::any save() override;
  FreeMotion restore(const std::any& state) override;

  int sub_steps() const { return sub_steps_; }
  double sub_step() const { return sub_step_; }  ///< s

 private:
  struct State {
    ExplicitMotion::Snapshot motion;
    ExplicitMotion::State begin;
    std::vector<VertexLoad> loads;
    std::vector<Vec3> free, positions;
    std::optional<MovingSupports::State> supports;
  };
  FreeMotion free_motion_now() const;
  void choose_sub_step(const ModelInputs& inputs);
  void precompute(const ModelInputs& inputs);
  void run_period(ExplicitMotion& motion, const std::vector<double>& force) const noexcept;
  template <class Act>
  void for_loads(const Act& act) const;
  void run_on() noexcept;
  void calm_loaded() noexcept;
  void update_free() noexcept;
  void apply_loads(std::span<const VertexLoad> loads) noexcept;

  SurfaceCompliance compliance_;
  ElasticTensors tensors_;
  int instants_ = 1;                          // within a step of the scene
  int sub_steps_ = 1;                         // from one to the next
  double sub_step_ = 0;                       // s
  ExplicitMotion motion_;                     // at the end of the period, free of loads
  ExplicitMotion::State start_;               // at its beginning
  std::vector<double> force_;                 // over it, N
  std::vector<VertexLoad> loads_;             // over it
  std::optional<MovingSupports> supports_;    // where some move
  std::optional<PublishedMotion> published_;  // unless the scene leaves it out
  std::vector<int> first_;  // per surface vertex: its first number in `motion_`, or -1: fixed
  std::vector<Vec3> rest_, free_, positions_;  // m
  std::vector<Vec3> mesh_rest_;                // of all vertices, m
  mutable std::vector<Vec3> nodes_;            // of `nodes`
};

}  // namespace palpate::sim
