#include "haptic_client/session/whole_error.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/text.h"

namespace palpate::client {
namespace {

Json percent_of(const DiscretisationError& error) {
  return error.known() ? Json(error.percent) : Json(nullptr);
}

std::string how_of(const DiscretisationError& error) {
  switch (error.source) {
    case ErrorSource::kUnknown:
      return "unknown: nobody has measured it; `sim_server study SCENE --out DIR` does";
    case ErrorSource::kEstimated:
      return "estimated by elements to a radius of the tool where it pressed; `sim_server study SCENE --out "
             "DIR` "
             "measures it";
    case ErrorSource::kMeasured:
      return "measured by a study of this scene, along its motion";
    case ErrorSource::kNone:
      return "none: the force follows from the place of the tool alone";
  }
  return "";
}

}  // namespace

Json error_budget_report(const std::string& method, const Observation& observation) {
  const DiscretisationErrors published = observation.published_errors().mean();
  const Scoring& scoring = observation.scoring();
  Json report = {{"mesh_percent", percent_of(published.mesh)},
                 {"motion_percent", percent_of(published.time_step)},
                 {"extrapolation_percent", nullptr},
                 {"how",
                  {{"mesh", published.mesh.source == ErrorSource::kNone ? "none: this tissue has no mesh"
                                                                        : how_of(published.mesh)},
                   {"motion", how_of(published.time_step)},
                   {"extrapolation", "unknown: nothing was rendered between two samples"}}}};
  const auto row = std::ranges::find(scoring.names(), method);
  if (row == scoring.names().end() || scoring.scored() == 0) return report;
  const auto at = static_cast<std::size_t>(row - scoring.names().begin());
  const double percent = scoring.metrics(at).mean_percent;
  if (std::isnan(percent)) return report;
  report["extrapolation_percent"] = percent;
  report["how"]["extrapolation"] =
      fmt::format("measured here, latency included, against the force between samples ({})",
                  name_of(scoring.mostly_between()));
  return report;
}

void print_error_budget(const Json& tool) {
  const Json& rendered = tool["rendered"];
  if (rendered["laws"].empty()) return;
  fmt::print(
      "  error   of the force, % of its root mean square; the law of the tissue itself is not in it\n");
  const auto row = [&](const char* name, const char* percent, const char* how) {
    const std::string number =
        rendered[percent].is_null() ? "?" : two_figures(rendered[percent].get<double>());
    fmt::print("          {:<14}{:>7}   {}\n", name, number, rendered["how"][how].get<std::string>());
  };
  row("mesh", "mesh_percent", "mesh");
  row("time step", "motion_percent", "motion");
  row("extrapolation", "extrapolation_percent", "extrapolation");
}

}  // namespace palpate::client
