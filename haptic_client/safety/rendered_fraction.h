#pragma once
#include "common/types.h"

namespace palpate::client {

/// Measures which fraction of the law's force is rendered, for a warning when the safety chain removes most
/// of it for long. Pure; haptic thread only.
class RenderedFraction {
 public:
  static constexpr double kHalf = 0.5;     ///< of the law's force
  static constexpr double kWeakFor = 0.5;  ///< s
  static constexpr double kLeast = 0.2;    ///< N: a smaller force is not watched

  /// Adds a tick of `dt` (s) in which the law returned `law_D` (N) and the device got `written_D` (N).
  void tick(const Vec3& law_D, const Vec3& written_D, double dt) noexcept {
    const double law = law_D.stableNorm();
    const bool weak = law > kLeast && written_D.dot(law_D / law) < kHalf * law;
    weak_s_ = weak ? weak_s_ + dt : 0;
    total_s_ += weak ? dt : 0;
  }
  /// The force is meant to be less: it was switched off, or fades.
  void restart() noexcept { weak_s_ = 0; }

  /// True if less than half of the force has been rendered for half a second.
  bool weak() const noexcept { return weak_s_ >= kWeakFor; }
  /// Over the session, s.
  double total_s() const noexcept { return total_s_; }

 private:
  double weak_s_ = 0, total_s_ = 0;
};

}  // namespace palpate::client
