#pragma once
#include <string>
#include <vector>

#include "common/damped_mode.h"
#include "sim_server/deformation/slow_modes.h"
#include "sim_server/deformation/surface_compliance.h"

namespace palpate::sim {

struct LinearStatics;

/// What clients are told of a linear tissue in motion whose model itself needs neither modes nor statics: the
/// slow modes, where they stand, and the static compliance of all the rest at the surface. One thread; only
/// set-up allocates.
class ToldMotion {
 public:
  /// `places`: of each node among the unknowns of the model, three a place, or -1: held. `masses`: of each
  /// place, kg. Throws `Error` as `SurfaceCompliance` and `vibration_modes`.
  ToldMotion(const ModelInputs& inputs, const LinearStatics& statics, std::span<const int> places,
             std::span<const double> masses);

  const SlowModes& modes() const { return modes_; }

  /// Projects a state of the model: displacements u (m), velocities v (m/s) that are `late` (s) behind them,
  /// and forces f (N) held until then. O(unknowns x modes).
  void begin(std::span<const double> u, std::span<const double> v, std::span<const double> f,
             double late) noexcept;
  /// Amplitudes of the told modes alone, of displacements u (m).
  const Eigen::VectorXd& amplitudes(std::span<const double> u) noexcept;
  /// From there by `time` (s) under loads that are held, to amplitudes and rates.
  void advance(double time, std::span<const NodalLoad> loads, Eigen::Ref<Eigen::VectorXd> q,
               Eigen::Ref<Eigen::VectorXd> v) noexcept;
  /// Of the surface that bears these loads, as one piece, to a force held for `seconds`, m/N; what is quicker
  /// than the told modes is at rest by then.
  Mat3 compliance(std::span<const NodalLoad> loads, double seconds) const noexcept {
    return residual_.of_loads(loads) + modes_.give_way(loads, seconds, 0, modes_.told);
  }
  void residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
    residual_.fill(vertices, patch);
  }

  std::size_t bytes() const;
  std::string detail() const;

 private:
  ToldMotion(const ModelInputs& inputs, const LinearStatics& statics, const VibrationModes& found,
             std::span<const int> places, std::span<const double> masses);

  SlowModes modes_;
  SurfaceCompliance residual_;
  Eigen::MatrixXd shapes_;         // (unknowns of the model x told modes), 1/sqrt(kg)
  Eigen::VectorXd masses_;         // (unknowns) kg
  Eigen::VectorXd weighted_;       // (unknowns) of the vector that is projected
  Eigen::VectorXd q_, v_, force_;  // (told modes)
  std::vector<ModeStep> steps_;    // (told modes) over `stepped_`
  double stepped_ = -1;            // s
};

}  // namespace palpate::sim
