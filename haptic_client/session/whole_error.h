#pragma once
#include <array>
#include <optional>
#include <string>

#include "common/report.h"
#include "haptic_client/evaluation/observation.h"

namespace palpate::client {

/// One figure of the error of the force on the hand, as report and page name it.
struct HandError {
  const char *name, *key, *how;  ///< for people; in REPORT.md; where it comes from
  /// Returns it, % of the root mean square of the force that was right; NaN where it is not known. Haptic
  /// thread, too; does not allocate.
  double (*percent)(const Observation&) noexcept;
};
/// The total, without a name, then its measured parts, then the worst tick.
extern const std::array<HandError, 6> kHandErrors;

/// Returns the 99th percentile of the age of the force, ms, where the rates do not explain it and the threads
/// that carry it had no real-time priority; else nothing. Around its median the age differs by the wait for
/// the next sample, half a period of the samples, by half a period for which packed ticks wait, and by a
/// tick. `tool`: its report.
std::optional<double> unexplained_age_ms(const Json& tool);

/// Error of the force on the hand, from the organ's mesh to the motors: `rendered.total_percent` and its
/// parts (session/REPORT.md); null where nobody knows.
Json whole_error_report(const Observation& observation);

/// Returns the total of that report in words: "at most 5.9 % of its root mean square in the mean", or what is
/// known of it.
std::string total_text(const Json& rendered);

/// Prints that report of a tool for people, on stdout, the total first; nothing before the first sample.
void print_whole_error(const Json& tool);

}  // namespace palpate::client
