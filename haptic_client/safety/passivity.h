#pragma once
#include <algorithm>
#include <cstdint>

#include "common/types.h"

namespace palpate::client {

/// What the passivity observer saw and its controller did.
struct PassivityCounts {
  std::uint64_t reduced = 0;  ///< ticks with less force than wished
  double largest_debt_j = 0;  ///< most energy given beyond what had been put in, J
};

/// A tissue gives back at most the work that was put into it, whatever sampling, latency and extrapolation
/// make of it. The observer (time domain: Hannaford and Ryu 2002, equation 13) adds up the work of the force
/// that was *written* on the handle,
///   E += f . (x - x_before).
/// Where E > 0 the motors gave more than they took, and the controller scales the force by exp(-(E /
/// debt)^2): the wall goes softer until the hand can hold it. The share falls at once and recovers within 100
/// ms. A hand surely takes `allowance`; credit left over when nothing pushes any more is forgotten at once,
/// debt within 0.3 s. A brake, as in the paper, was tried: on a filtered velocity it chatters where the debt
/// is near zero, and costs good laws ten times the force error. Pure; haptic thread only.
class Passivity {
 public:
  struct Settings {
    bool enabled = true;
    double debt = 1e-3;       ///< J, [1e-6, 10]: the force falls to 1/e where the motors owe so much
    double allowance = 1e-3;  ///< W, [0, 10]
  };
  explicit Passivity(const Settings& settings) : settings_(settings) {}

  /// The handle moved by `d_D` (m) within `dt` (s) under the force that was written last.
  void moved(const Vec3& d_D, double dt) noexcept;
  /// The share of the force that may be written now, (0, 1].
  double share(double dt) noexcept;
  /// Nothing is owed: what was given was meant to be, as in a soft start.
  void forgive() noexcept { energy_ = std::min(energy_, 0.0); }
  /// What went to the motors in the end.
  void wrote(const Vec3& f_D) noexcept { written_ = f_D; }

  const PassivityCounts& counts() const noexcept { return counts_; }

 private:
  Settings settings_;
  Vec3 written_ = Vec3::Zero();
  double energy_ = 0;  // J
  double share_ = 1;
  PassivityCounts counts_;
};

}  // namespace palpate::client
