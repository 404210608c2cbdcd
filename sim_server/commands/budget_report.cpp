#include "sim_server/commands/budget_report.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace palpate::sim {

Json budget_report(const Simulation& simulation) {
  const auto [steps, largest_residual] = simulation.budget_use();
  return {{"steps", steps}, {"largest_residual", largest_residual}};
}

std::string budget_text(const Simulation& simulation) {
  const auto [steps, largest_residual] = simulation.budget_use();
  if (steps == 0) return {};
  return fmt::format(
      "{} steps ended by [deformation] budget_ms before they had converged, with at most {:.2g} % of the "
      "forces unbalanced",
      steps, 100 * largest_residual);
}

}  // namespace palpate::sim
