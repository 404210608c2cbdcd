#pragma once

namespace palpate {

/// Largest number of published modes: a page of the spectrum has three values for each.
constexpr int kMaxPublishedModes = 75;
/// Highest frequency of a published mode, rad/s (80 Hz). A client applies the contact force one tick late,
/// which at 500 ticks a second is one radian of it.
constexpr double kFastestPublishedMode = 500;
/// Largest damping of a published slow mode (1/s); a more strongly damped one hardly moves within a tick.
constexpr double kMaxPublishedDamping = 1000;

/// Step of one mode of a damped linear motion, q'' + d q' + w^2 q = p, over a time under a constant force p.
/// Maps q, q' and p at its start to q and q' at its end. Exact, whatever the time and the damping.
struct ModeStep {
  double q_of_q = 1, q_of_v = 0, v_of_q = 0, v_of_v = 1, q_of_p = 0, v_of_p = 0;

  /// `w`: angular frequency, rad/s > 0; `damping`: d, 1/s >= 0; `time`: s >= 0.
  static ModeStep over(double time, double w, double damping) noexcept;

  void advance(double& q, double& v, double p) const noexcept {
    const double from = q;
    q = q_of_q * from + q_of_v * v + q_of_p * p;
    v = v_of_q * from + v_of_v * v + v_of_p * p;
  }
};

}  // namespace palpate
