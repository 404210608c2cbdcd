#pragma once
#include <string>

namespace palpate::client {

/// What a law costs, ns, medians of several rounds.
struct LawCost {
  double tick_ns = 0;     ///< a force
  double arrival_ns = 0;  ///< taking a sample
};

/// Measured here and now, in a few milliseconds, on samples that carry all there is.
LawCost cost_of(const std::string& law);

}  // namespace palpate::client
