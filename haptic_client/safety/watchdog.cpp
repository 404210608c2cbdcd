#include "haptic_client/safety/watchdog.h"

#include <algorithm>

#include "common/ages.h"

namespace palpate::client {
Watchdog::Ruling Watchdog::rule(std::optional<Time> age, bool flagged, double dt) noexcept {
  // Up to this tick, the sample before was the newest.
  flagged_s_ = std::clamp(flagged_s_ + (flagged_ ? dt : -kSettles * dt), 0.0, kUnsettled);
  flagged_ = flagged;
  const bool unsettled = flagged_s_ >= kUnsettled, stale = !age || *age > kStale || unsettled;
  doubtful_ = unsettled || (doubtful_ && flagged_s_ > 0);
  if (stale && !fading_ && gain_ > 0) ++ramped_;
  fading_ = stale && gain_ > 0;
  gain_ = std::clamp(gain_ + (stale ? -dt / kFade : std::min(dt, kLongestTick) / kSoftStart), 0.0, 1.0);
  return {.gain = gain_, .damper = stale && gain_ > 0, .unsettled = unsettled};
}

}  // namespace palpate::client
