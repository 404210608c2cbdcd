#include "haptic_client/safety/watchdog.h"

#include <algorithm>

#include "common/ages.h"

namespace palpate::client {
Watchdog::Ruling Watchdog::rule(std::optional<Time> age, Time unsettled, double dt) noexcept {
  const bool stale = !age || *age > kStale || unsettled > kUnsettled;
  if (stale && !fading_ && gain_ > 0) ++ramped_;
  fading_ = stale && gain_ > 0;
  gain_ = std::clamp(gain_ + (stale ? -dt / kFade : std::min(dt, kLongestTick) / kSoftStart), 0.0, 1.0);
  return {.gain = gain_, .damper = stale && gain_ > 0};
}

}  // namespace palpate::client
