#pragma once
#include <filesystem>
#include <string>

namespace palpate::client {

/// What a law costs, ns: medians, and how long the slowest hundredth of the forces take at least.
struct LawCost {
  double tick_ns = 0;      ///< a force
  double tick_p99_ns = 0;  ///< 0: not measured
  double arrival_ns = 0;   ///< taking a sample
};

/// Measured here and now, in a few milliseconds, on samples that carry all there is.
LawCost cost_of(const std::string& law);

/// The same on the ticks of a run of a capture (`CaptureSurvey::runs`) that push, as long as it lasts; for
/// laws whose cost depends on what is touched. The time of this thread, without what others took of the
/// processor; less the median of what reading that clock takes, measured in the same run, so that it compares
/// with `cost_of`, which reads no clock between calls.
LawCost cost_on(const std::string& law, const std::filesystem::path& capture, std::size_t run);

}  // namespace palpate::client
