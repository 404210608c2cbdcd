#pragma once
/// Time is an argument everywhere; only common/clock asks what time it is.
#include <chrono>

namespace palpate {

/// A point on some monotonic clock, or a span of it. Which clock is the owner's business: stamps of two
/// programs are never subtracted from each other.
using Time = std::chrono::nanoseconds;

/// Seconds as a double, for formulas.
constexpr double to_seconds(Time t) {
  return std::chrono::duration<double>(t).count();
}

/// The nearest whole nanosecond to `s` seconds; |s| must stay under 2^63 ns (292 years).
constexpr Time from_seconds(double s) {
  return Time{static_cast<Time::rep>(s * 1e9 + (s < 0 ? -0.5 : 0.5))};
}

}  // namespace palpate
