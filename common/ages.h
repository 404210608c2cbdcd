#pragma once
#include "common/time.h"

namespace palpate {

/// A link is silent, and a force too old to be rendered, when the newest sample is older than this. One
/// number for the session (which asks the server again), the laws (which look back at nothing from before it)
/// and the watchdog (which fades the force).
constexpr Time kOutage = std::chrono::milliseconds(300);

/// The longest time that one haptic tick may count for, s: a loop that stalled does not come back with a
/// blow.
constexpr double kLongestTick = 0.01;

/// Two ticks further apart than this do not follow each other: between them the loop was held up. A fifth
/// more than the period of the slowest loop, 100 Hz.
constexpr Time kTickGap = std::chrono::milliseconds(12);

}  // namespace palpate
