#pragma once
#include <string>
#include <vector>

#include "common/damped_mode.h"
#include "sim_server/deformation/slow_modes.h"
#include "sim_server/deformation/surface_compliance.h"

namespace palpate::sim {

struct LinearStatics;

/// As many modes as a scene's `client_modes` asks for, or as the body has, of these masses of unknowns, kg.
/// Throws `Error` as `vibration_modes`.
VibrationModes told_modes(const ModelInputs& inputs, const LinearStatics& statics,
                          const Eigen::VectorXd& masses);

/// What clients are told of a linear tissue in motion whose model itself needs neither modes nor statics: the
/// slow modes, where they stand, and the static compliance of all the rest at the surface. One thread; only
/// set-up allocates.
class ToldMotion {
 public:
  /// `places`: of each node among the unknowns of the model, three a place, or -1: held. `masses`: of each
  /// place, kg. Throws `Error` as `SurfaceCompliance` and `vibration_modes`.
  ToldMotion(const ModelInputs& inputs, const LinearStatics& statics, std::span<const int> places,
             std::span<const double> masses);
  /// The same with modes that were found before (`told_modes`).
  ToldMotion(const ModelInputs& inputs, const LinearStatics& statics, const VibrationModes& found,
             std::span<const int> places, std::span<const double> masses);

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
  /// To amplitudes as they were `time` (s) before it, and rates as they are where these loads, too, have
  /// pushed since.
  void push(double time, std::span<const NodalLoad> loads, Eigen::Ref<Eigen::VectorXd> q,
            Eigen::Ref<Eigen::VectorXd> v) noexcept;
  /// Where the model has no state over all unknowns: goes on by `time` (s) under these loads, from where it
  /// stood before, or `before` stands, or where they hold it; a linear body's modes go so by themselves.
  void go_on(double time, std::span<const NodalLoad> loads) noexcept { advance(time, loads, q_, v_); }
  void stand_as(const ToldMotion& before) noexcept;
  void stand_under(std::span<const NodalLoad> loads) noexcept;
  const Eigen::VectorXd& amplitudes() const noexcept { return q_; }
  const Eigen::VectorXd& rates() const noexcept { return v_; }

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
