#pragma once
#include <string>

#include "common/report.h"
#include "sim_server/simulation/simulation.h"

namespace palpate::sim {

/// Of steps that ended because their budget did ([deformation] budget_ms), for reports: {"steps": ...,
/// "largest_residual": ...}.
Json budget_report(const Simulation& simulation);
/// The same in words; empty: there were none.
std::string budget_text(const Simulation& simulation);

}  // namespace palpate::sim
