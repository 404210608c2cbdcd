#pragma once
#include <string>

namespace palpate::client {

/// Nanoseconds that one tick of a law takes on this machine (name of `extrapolators()`): its force, asked
/// through `ForceEstimate` with a moving tool; median of nine rounds of 20 000 ticks. Takes a few
/// milliseconds: not for a running loop.
double ns_per_tick(const std::string& law);

}  // namespace palpate::client
