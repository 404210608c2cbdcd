#pragma once
#include "common/report.h"
#include "haptic_client/evaluation/observation.h"

namespace palpate::client {

/// `rendered.mesh_percent`, `.motion_percent`, `.extrapolation_percent` and `.how` of a tool that rendered
/// `method`; null where nobody knows. Of extrapolation, what the row of `method` scored.
Json error_budget_report(const std::string& method, const Observation& observation);

/// Prints that report as a table, for people, on stdout; nothing before the first sample of a force.
void print_error_budget(const Json& tool);

}  // namespace palpate::client
