#pragma once
#include <array>
#include <string>
#include <string_view>

#include "common/config.h"
#include "sim_server/deformation/estimated_memory.h"
#include "sim_server/deformation/moving_supports.h"
#include "sim_server/deformation/rayleigh_damping.h"
#include "sim_server/deformation/surface_compliance.h"
#include "sim_server/solvers/vibration_modes.h"

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
/// over T = 1 / rate_hz of the scene under loads that are held: no step is too long. Set-up finds the modes
/// and
///   W = J K^-1 J^T + sum_k J phi_k (r_k - 1 / w_k^2) (J phi_k)^T,
/// r_k the displacement of mode k within T per force on it. A step takes a few columns of W and one pass over
/// modes and surface vertices. What moving supports do is added to that, of all modes and exact in time
/// (`support_responses`).
class Reduced : public DeformationModel {
 public:
  /// Throws `Error` as `SurfaceCompliance`, or when K is singular, `rate_hz` 0, or modes not to be had.
  explicit Reduced(const ModelInputs& inputs);
  /// Before anything is allocated.
  static double estimated_bytes(const Scene& scene, const MeshCounts& counts);
  /// Any `dt` > 0 is taken for one period.
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  const ComplianceSource* compliance_source() const noexcept override { return &compliance_; }
  bool compliance_is_constant() const noexcept override { return true; }
  std::span<const Vec3> apply(std::span<const NodalLoad> loads) noexcept override;
  std::vector<MemoryPart> memory() const override;

 private:
  /// How one mode goes over T: of q, q' and a held force per unit mass p at its beginning to those at its
  /// end.
  struct Step {
    double q_of_q, q_of_v, v_of_q, v_of_v, q_of_p, v_of_p;
  };
  static Step step_of(double w, double damping, double period);

  /// The surface as its supports move it.
  std::span<const Vec3> unloaded() const noexcept { return supports_ ? supports_->positions() : rest_; }
  void press(std::span<const NodalLoad> loads) noexcept;

  double period_;  // s
  std::vector<Vec3> rest_, free_, positions_;
  SurfaceCompliance compliance_;
  std::optional<MovingSupports> supports_;  // where some move
  std::vector<Step> steps_;                 // (modes)
  Eigen::MatrixXd shapes_;                  // (3 surface vertices x modes), 1/sqrt(kg)
  Eigen::VectorXd q_, v_, p_, q_free_;      // (modes) m sqrt(kg), m sqrt(kg)/s, N/sqrt(kg)
  Eigen::VectorXd moved_;                   // (3 surface vertices) m
  std::vector<NodalLoad> loads_;            // of the last `apply`
};

}  // namespace palpate::sim
