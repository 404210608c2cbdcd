#pragma once
#include <cstdint>
#include <optional>

#include "common/ages.h"

namespace palpate::client {

/// The safety ladder for old forces (one policy everywhere): by the age of the newest sample,
///   up to 3 periods beyond the usual   everything
///   up to 300 ms      extrapolation in time goes back (`ForceEstimate`); laws of position are still springs
///   beyond            the force fades to zero within 100 ms, a damper on while it does
/// and the same for a force that the server flags as not settled for 100 ms, in a row or with settled samples
/// between, of which each second takes half a second off; when samples come again, or for the first time, it
/// rises over 1 s. Pure; haptic thread only.
class Watchdog {
 public:
  static constexpr Time kStale = kOutage;
  static constexpr double kUnsettled = 0.1;  ///< s, three steps at 30 Hz
  static constexpr double kSettles = 0.5;    ///< s of flagged time that a settled second takes off
  static constexpr double kFade = 0.1;       ///< s, from full force to none
  static constexpr double kSoftStart = 1.0;  ///< s, from none to full force

  /// Limits of this tick.
  struct Ruling {
    double gain = 0;         ///< [0, 1], to multiply the force with
    bool damper = false;     ///< brake while fading
    bool unsettled = false;  ///< flagged for too long: that alone fades the force
  };

  /// `age`: of the newest sample, none if there is none yet. `flagged`: the server calls that sample not
  /// settled. `dt` (s): since the last tick.
  Ruling rule(std::optional<Time> age, bool flagged, double dt) noexcept;

  /// True from the tick in which flagged samples begin to fade the force until settled ones have made up for
  /// all of their time (200 ms at most): not a state that comes and goes with each sample.
  bool doubtful() const noexcept { return doubtful_; }

  /// Returns the gain of the last ruling.
  double gain() const noexcept { return gain_; }

  /// Force from none again, over a soft start.
  void restart() noexcept { gain_ = 0; }

  /// Returns how often the force was faded.
  std::uint64_t ramped() const noexcept { return ramped_; }

 private:
  double gain_ = 0;
  double flagged_s_ = 0;  // s, [0, kUnsettled]
  bool flagged_ = false, doubtful_ = false, fading_ = false;
  std::uint64_t ramped_ = 0;
};

}  // namespace palpate::client
