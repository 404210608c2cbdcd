#pragma once
#include <filesystem>
#include <string>

namespace palpate::client {

/// Cost of a law, ns: medians, and the least time of the slowest hundredth of the forces.
struct LawCost {
  double tick_ns = 0;      ///< a force
  double tick_p99_ns = 0;  ///< 0: not measured
  double arrival_ns = 0;   ///< taking a sample
};

/// Measured here and now, in a few milliseconds, on samples that carry all there is.
LawCost cost_of(const std::string& law);

/// Measures the cost on the ticks in contact of a run of a capture (`CaptureSurvey::runs`), for as long as
/// the run lasts. It serves laws whose cost depends on the contact. Counts the time of this thread, without
/// what others took of the processor. Subtracts the median time of reading that clock, measured in the same
/// run, so that the result compares with `cost_of`, which reads no clock between calls.
LawCost cost_on(const std::string& law, const std::filesystem::path& capture, std::size_t run);

}  // namespace palpate::client
