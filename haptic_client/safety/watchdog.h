#pragma once
#include <cstdint>
#include <optional>

#include "common/ages.h"

namespace palpate::client {

/// The safety ladder for old forces (one policy everywhere): by the age of the newest sample,
///   up to 3 periods beyond the usual   everything
///   up to 300 ms      extrapolation in time goes back (`ForceEstimate`); laws of position are still springs
///   beyond            the force fades to zero within 100 ms, a damper on while it does
/// and the same for a force that the server has flagged as not settled for more than 100 ms; when samples
/// come again, or for the first time, it rises over 1 s. Pure; haptic thread only.
class Watchdog {
 public:
  static constexpr Time kStale = kOutage;
  static constexpr Time kUnsettled = std::chrono::milliseconds(100);  ///< three steps at 30 Hz
  static constexpr double kFade = 0.1;                                ///< s, from full force to none
  static constexpr double kSoftStart = 1.0;                           ///< s, from none to full force

  /// Limits of this tick.
  struct Ruling {
    double gain = 0;      ///< [0, 1], to multiply the force with
    bool damper = false;  ///< brake while fading
  };

  /// `age`: of the newest sample, none if there is none yet. `unsettled`: for how long samples have been
  /// flagged by now, 0 if the newest is not. `dt` (s): since the last tick.
  Ruling rule(std::optional<Time> age, Time unsettled, double dt) noexcept;

  /// Returns the gain of the last ruling.
  double gain() const noexcept { return gain_; }

  /// Force from none again, over a soft start.
  void restart() noexcept { gain_ = 0; }

  /// Returns how often the force was faded.
  std::uint64_t ramped() const noexcept { return ramped_; }

 private:
  double gain_ = 0;
  bool fading_ = false;
  std::uint64_t ramped_ = 0;
};

}  // namespace palpate::client
