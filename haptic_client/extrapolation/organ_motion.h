#pragma once
#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// Rigid motion of the organ under the tool, to second order in time: since the newest sample, by
///   s(t) = v_n (t - t_n) + a (t - t_n)^2 / 2,   a = (v_n - v_(n-1)) / (t_n - t_(n-1)),
/// v the velocity of its surface that samples tell. Of a smooth motion with jerk j, off by at most
/// max |j| ((t - t_n)^3 / 6 + (t_n - t_(n-1)) (t - t_n)^2 / 4). An organ at rest stays where it is, bit by
/// bit. Without acceleration where the two samples do not belong together: after an outage, or where it would
/// be more than any organ's (the tool has come to something else). What other tools add to v has no
/// acceleration where it changes by more than half of itself: one of them has come, or gone. About 2 ns.
class OrganMotion {
 public:
  static constexpr double kFastest = 10;  ///< m/s: what goes faster is no organ, and stands still
  /// A sample later than the one before. Without `at_tool` it says nothing of motion, and the organ rests.
  void update(const Sample& sample) noexcept;
  /// Forgets all samples.
  void restart() noexcept { *this = {}; }
  /// s(t), m, world; t >= t_n. Zero before the first sample.
  Vec3 since_sample(Time t) const noexcept {
    const double age = to_seconds(t - t_);
    return age * (v_ + 0.5 * age * a_);
  }

 private:
  Time t_{};  // t_n
  bool known_ = false;
  Vec3 v_ = Vec3::Zero(), a_ = Vec3::Zero();  // m/s, m/s^2
  Vec3 others_ = Vec3::Zero();                // of v_, by other tools
};

}  // namespace palpate::client
