#pragma once
#include <string>
#include <vector>

#include "common/damped_mode.h"
#include "sim_server/client_model/slow_modes.h"
#include "sim_server/statics/surface_compliance.h"

namespace palpate::sim {

struct LinearStatics;

/// Returns the modes that a scene's `client_modes` requests, or as many as the body has, for these masses of
/// the unknowns (kg). Throws `Error` as `vibration_modes`.
VibrationModes published_modes(const ModelInputs& inputs, const LinearStatics& statics,
                               const Eigen::VectorXd& masses);

/// Modes, modal state and residual compliance of a linear body in motion whose model needs neither modes nor
/// statics itself. One thread; only set-up allocates.
class PublishedMotion {
 public:
  /// `places`: of each node among the unknowns of the model, three a place, or -1: held. `masses`: of each
  /// place, kg. Throws `Error` as `SurfaceCompliance` and `vibration_modes`.
  PublishedMotion(const ModelInputs& inputs, const LinearStatics& statics, std::span<const int> places,
                  std::span<const double> masses);
  /// Takes modes that were computed before (`published_modes`).
  PublishedMotion(const ModelInputs& inputs, const LinearStatics& statics, const VibrationModes& found,
                  std::span<const int> places, std::span<const double> masses);

  const PublishedModes& modes() const { return modes_; }

  /// Projects a state of the model: displacements u (m), velocities v (m/s) that are `late` (s) behind them,
  /// and forces f (N) held until then. O(unknowns x modes).
  void begin(std::span<const double> u, std::span<const double> v, std::span<const double> f,
             double late) noexcept;
  /// Amplitudes of the published modes alone, of displacements u (m).
  const Eigen::VectorXd& amplitudes(std::span<const double> u) noexcept;
  /// Advances that state by `time` (s) under constant loads, and writes amplitudes and rates.
  void advance(double time, std::span<const VertexLoad> loads, Eigen::Ref<Eigen::VectorXd> q,
               Eigen::Ref<Eigen::VectorXd> v) noexcept;
  /// Writes the amplitudes `time` (s) before that state, and the rates that these loads added since.
  void push(double time, std::span<const VertexLoad> loads, Eigen::Ref<Eigen::VectorXd> q,
            Eigen::Ref<Eigen::VectorXd> v) noexcept;
  /// Advances the modes by `time` (s) under these loads, for a model without a state over all unknowns: from
  /// their own state, from that of `before`, or from equilibrium under the loads.
  void continue_(double time, std::span<const VertexLoad> loads) noexcept { advance(time, loads, q_, v_); }
  void place_as(const PublishedMotion& before) noexcept;
  void place_under(std::span<const VertexLoad> loads) noexcept;
  const Eigen::VectorXd& amplitudes() const noexcept { return q_; }
  const Eigen::VectorXd& rates() const noexcept { return v_; }
  void set(const Eigen::VectorXd& amplitudes, const Eigen::VectorXd& rates) {
    q_ = amplitudes;
    v_ = rates;
  }

  /// Returns the compliance (m/N) of the surface that bears these loads, as one piece, to a force held for
  /// `seconds`. Modes faster than the published ones are in equilibrium then.
  Mat3 compliance(std::span<const VertexLoad> loads, double seconds) const noexcept {
    return residual_.of_loads(loads) + modes_.yield_(loads, seconds, 0, modes_.published);
  }
  void residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
    residual_.fill(vertices, patch);
  }

  std::size_t bytes() const;
  std::string detail() const;

 private:
  PublishedModes modes_;
  SurfaceCompliance residual_;
  Eigen::MatrixXd shapes_;         // (unknowns of the model x published modes), 1/sqrt(kg)
  Eigen::VectorXd masses_;         // (unknowns) kg
  Eigen::VectorXd weighted_;       // (unknowns) of the vector that is projected
  Eigen::VectorXd q_, v_, force_;  // (published modes)
  std::vector<ModeStep> steps_;    // (published modes) over `stepped_`
  double stepped_ = -1;            // s
};

}  // namespace palpate::sim
