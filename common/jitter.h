#pragma once
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/time.h"

namespace palpate {

/// Measures by how much the delays of datagrams jitter, and leaves out what a queue does to them. Jitter
/// makes one datagram later and the next one earlier: the covariance of two changes of delay in a row is
/// minus its variance. A queue that grows or drains makes both changes alike, and that covariance positive.
/// Pure; no allocation.
class Jitter {
 public:
  /// Takes the delay of the next datagram, from when it was made until it came.
  void add(Time delay) noexcept {
    const double now = std::clamp(to_seconds(delay), 0.0, kMostDelay), change = now - last_.value_or(now);
    opposed_ += (-change * change_ - opposed_) / kDatagrams;
    change_ = change;
    last_ = now;
  }
  /// Returns the standard deviation of delays on a way without a queue.
  Time deviation() const noexcept { return from_seconds(std::sqrt(std::max(opposed_, 0.0))); }
  /// Returns how much of a delay may be jitter.
  Time most() const noexcept { return kDeviations * deviation(); }

 private:
  static constexpr double kMostDelay = 2;   // s: of one datagram that came later still
  static constexpr double kDatagrams = 16;  // over which the variance is a mean, half a second at 30 Hz
  static constexpr int kDeviations = 4;
  std::optional<double> last_;       // s
  double change_ = 0, opposed_ = 0;  // from the one before, s; minus the covariance of two, s^2
};

}  // namespace palpate
