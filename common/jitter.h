#pragma once
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/time.h"

namespace palpate {

/// How much the delays of datagrams that come one after the other jitter, told from a queue: jitter makes one
/// later and the next earlier, so that the covariance of two changes in a row is minus its variance; a queue
/// that grows or drains makes both alike. Over some 16 datagrams. Pure; no allocation.
class Jitter {
 public:
  /// A datagram came so long after it was made.
  void heard(Time delay) noexcept {
    const double now = std::clamp(to_seconds(delay), 0.0, 2.0), change = now - last_.value_or(now);
    opposed_ += (-change * change_ - opposed_) / 16;
    change_ = change;
    last_ = now;
  }
  /// Returns the standard deviation of delays on a way without a queue.
  Time deviation() const noexcept { return from_seconds(std::sqrt(std::max(opposed_, 0.0))); }
  /// Returns how much of a delay may be jitter: four times that.
  Time most() const noexcept { return 4 * deviation(); }

 private:
  std::optional<double> last_;       // s
  double change_ = 0, opposed_ = 0;  // from the one before, s; minus the covariance of two, s^2
};

}  // namespace palpate
