#pragma once
#include "common/report.h"
#include "haptic_client/evaluation/observation.h"

namespace palpate::client {

/// Error of the force on the hand, from the organ's mesh to the motors: `rendered.total_percent` and its
/// parts (session/REPORT.md); null where nobody knows.
Json whole_error_report(const Observation& observation);

/// Prints that report of a tool for people, on stdout, the total first; nothing before the first sample.
void print_whole_error(const Json& tool);

}  // namespace palpate::client
