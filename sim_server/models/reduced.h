#pragma once
#include <array>
#include <string>
#include <string_view>

#include "common/config.h"
#include "common/damped_mode.h"
#include "sim_server/client_model/slow_modes.h"
#include "sim_server/statics/moving_supports.h"
#include "sim_server/statics/surface_compliance.h"
#include "sim_server/tissue/contact_instants.h"
#include "sim_server/tissue/estimated_memory.h"

namespace palpate::sim {

struct ReducedSettings {
  int modes = 40;  ///< that swing, [1, 1000]

  static constexpr std::array<std::string_view, 1> kKeys{"modes"};
  static ReducedSettings read(const Config& config);
  std::string to_text() const;
};

/// Linear tissue of which only the slowest `modes` swing; all the rest follows the loads at once, as in
/// statics (residual flexibility: MacNeal 1971, Comput. Struct. 1:581; Craig 1981, Structural Dynamics,
/// chapter 18). So it rests where `quasi_static` does, whatever the number of modes; what is left out is the
/// inertia of the quick ones. Each mode q'' + (alpha + beta w^2) q' + w^2 q = phi^T f is stepped exactly
/// over T, from one instant of contact to the next, under loads that are held: no step is too long. Set-up
/// finds the modes and
///   W = J K^-1 J^T + sum_k J phi_k (r_k - 1 / w_k^2) (J phi_k)^T,
/// r_k the displacement of mode k within T per force on it. A step takes a few columns of W and one pass over
/// modes and surface vertices. What moving supports do is added to that, of all modes and exact in time
/// (`support_responses`).
class Reduced final : public DeformationModel,
                      public ClientModel,
                      public LaterCompliance,
                      public StatefulModel {
 public:
  /// Throws `Error` as `SurfaceCompliance`, or when K is singular, `rate_hz` 0, or modes not to be had.
  explicit Reduced(const ModelInputs& inputs);
  /// Before anything is allocated.
  static double estimated_bytes(const Scene& scene, const MeshCounts& counts);
  /// Any `dt` > 0 is taken for one period.
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::span<const Vec3> apply(std::span<const VertexLoad> loads) noexcept override;
  Mat3 later_compliance(std::span<const VertexLoad> loads, double seconds) const noexcept override;
  const PublishedModes* modes() const noexcept override { return &*modes_; }
  void read_modes(ModalMotion& state) noexcept override;
  void residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  ModelTraits traits() noexcept override;
  std::vector<MemoryPart> memory() const override;
  std::any save() override;
  FreeMotion restore(const std::any& state) override;

 private:
  struct State {
    Eigen::VectorXd q, v, p, q_free;  // (modes) m sqrt(kg), m sqrt(kg)/s, N/sqrt(kg), m sqrt(kg)
    std::vector<VertexLoad> loads;    // of the last `apply`
    std::vector<Vec3> free, positions;
    std::optional<MovingSupports::State> supports;
  };
  static int usual_instants(double period, double w);
  FreeMotion free_motion_now() const;
  /// The surface as its supports move it.
  std::span<const Vec3> unloaded() const noexcept { return supports_ ? supports_->positions() : rest_; }
  void apply_loads(std::span<const VertexLoad> loads) noexcept;

  int instants_ = 1;  // within a step of the scene
  double period_;     // s, from one to the next
  std::vector<Vec3> rest_, free_, positions_;
  SurfaceCompliance compliance_;
  std::optional<MovingSupports> supports_;  // where some move
  std::vector<ModeStep> steps_;             // (modes)
  std::optional<PublishedModes> modes_;     // always there
  std::string modes_note_;
  Eigen::VectorXd beyond_residual_;     // (modes) m^2 kg/N: what of `compliance_` is theirs
  Eigen::VectorXd q_, v_, p_, q_free_;  // (modes) m sqrt(kg), m sqrt(kg)/s, N/sqrt(kg)
  Eigen::VectorXd moved_;               // (3 surface vertices) m
  std::vector<VertexLoad> loads_;       // of the last `apply`
};

}  // namespace palpate::sim
