#include "haptic_client/session/whole_error.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "common/perception.h"
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
      return "estimated, by elements to a radius of the tool or by presses on linear and quadratic ones; "
             "`sim_server study SCENE --out DIR` measures it";
    case ErrorSource::kMeasured:
      return "measured by a study of this scene, within a radius of the tool of where it pressed";
    case ErrorSource::kNone:
      return "none: the force follows from the place of the tool alone";
  }
  return "";
}

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A part of the error on the hand, % of the root mean square of the force; NaN where nothing was judged.
template <double RenderedErrorParts::*kPart>
double part_percent(const Observation& observation) noexcept {
  const RenderedError& rendered = observation.scoring().rendered();
  if (rendered.judged() == 0) return kUnknown;
  const RenderedErrorParts parts = rendered.parts();
  return std::isnan(parts.hand.mean_percent) ? kUnknown : parts.*kPart;
}

double worst_percent(const Observation& observation) noexcept {
  const RenderedError& rendered = observation.scoring().rendered();
  return rendered.judged() == 0 ? kUnknown : rendered.parts().hand.max_of_rms_percent;
}

}  // namespace

const std::array<HandError, 6> kHandErrors{{
    {"", "total_percent", "",
     [](const Observation& o) noexcept { return o.total_percent().value_or(kUnknown); }},
    {"extrapolation", "extrapolation_percent", "", part_percent<&RenderedErrorParts::extrapolation_percent>},
    {"outages", "outages_percent", "the law where no sample came for more than 300 ms",
     part_percent<&RenderedErrorParts::outages_percent>},
    {"fades", "fades_percent", "soft start, and fades of forces that were old or not settled",
     part_percent<&RenderedErrorParts::fades_percent>},
    {"limits", "limits_percent", "passivity, damping, largest force and slew",
     part_percent<&RenderedErrorParts::limits_percent>},
    {"worst tick", "hand_max_percent", "", worst_percent},
}};

std::optional<double> unexplained_age_ms(const Json& tool) {
  const auto samples_hz = tool["motion"]["sample_rate_hz"].get<double>();
  if (!tool.contains("loop") || tool["loop"]["real_time"].get<bool>() || samples_hz <= 0) return {};
  const Json& age = tool["force"]["age_ms"];
  const double explained =
      age["p50"].get<double>() + 1e3 / samples_hz + 1e3 / tool["loop"]["rate_hz"].get<double>();
  const auto p99 = age["p99"].get<double>();
  return p99 > explained ? std::optional(p99) : std::nullopt;
}

Json whole_error_report(const Observation& observation) {
  const DiscretisationErrors published = observation.published_errors().mean();
  const Scoring& scoring = observation.scoring();
  const bool judged = scoring.rendered().judged() > 0;
  Json report = {{"mesh_percent", percent_of(published.mesh)},
                 {"motion_percent", percent_of(published.time_step)},
                 {"judged_ticks", scoring.rendered().judged()},
                 {"unjudged_ticks", scoring.unjudged()},
                 {"unsettled_ticks", scoring.unsettled()},
                 {"how",
                  {{"mesh", published.mesh.source == ErrorSource::kNone ? "none: this tissue has no mesh"
                                                                        : how_of(published.mesh)},
                   {"motion", how_of(published.time_step)},
                   {"extrapolation",
                    judged ? fmt::format("measured here, latency included, against the force between samples "
                                         "({})",
                                         name_of(scoring.mostly_between()))
                           : "unknown: nothing was rendered between two samples"}}}};
  const RenderedErrorParts parts = scoring.rendered().parts();
  const bool touched = judged && !std::isnan(parts.hand.mean_percent);
  const auto known = [&](double percent) { return touched ? Json(percent) : Json(); };
  report["hand_percent"] = known(parts.hand.mean_percent);
  report["hand_p99_percent"] = known(parts.hand.p99_of_rms_percent);
  for (const HandError& error : kHandErrors) {
    const double percent = error.percent(observation);
    report[error.key] = std::isnan(percent) ? Json() : Json(percent);
  }
  return report;
}

namespace {

double percent_of_ticks(const Json& rendered, const char* key) {
  const double ticks = rendered["judged_ticks"].get<double>() + rendered["unjudged_ticks"].get<double>() +
                       rendered["unsettled_ticks"].get<double>();
  return 100 * rendered[key].get<double>() / std::max(ticks, 1.0);
}

/// A line where the samples themselves were not settled, so that they tell no truth; else nothing.
std::string unsettled_text(const Json& rendered) {
  const double percent = percent_of_ticks(rendered, "unsettled_ticks");
  return percent > 0 ? fmt::format(
                           "          {:.3g} % of the ticks could not be judged, since the server's own "
                           "samples were not in balance\n",
                           percent)
                     : "";
}

/// What is known of the law of the tissue itself.
std::string law_text(const Json& force) {
  const auto strained = force["strained"].get<double>(), samples = force["samples"].get<double>();
  return strained > 0 ? fmt::format(
                            "not known, and not in the sum: strained beyond what it is meant for in "
                            "{:.3g} % of the samples",
                            100 * strained / samples)
                      : "not known, and not in the sum: how well it describes this organ";
}

/// How old the force was, beside what a hand can tell; and what made it older than the rates do.
void print_age(const Json& tool) {
  fmt::print("          {}\n", beside_the_hand(tool["force"]["age_ms"]["p99"].get<double>(), " (p99)"));
  if (const auto age = unexplained_age_ms(tool)) {
    fmt::print(
        "          {:.0f} ms is later than the rates explain, and the threads that carry the force had no "
        "real-time priority: raise `ulimit -r` (rtprio in /etc/security/limits.conf)\n",
        *age);
  }
}

}  // namespace

std::string total_text(const Json& rendered) {
  constexpr const char* kOf = "% of its root mean square in the mean";
  if (!rendered["total_percent"].is_null())
    return fmt::format("at most {} {}", two_figures(rendered["total_percent"].get<double>()), kOf);
  return fmt::format("{} {}, and what mesh and time step add to it, which is not known",
                     two_figures(rendered["hand_percent"].get<double>()), kOf);
}

void print_whole_error(const Json& tool) {
  const Json& rendered = tool["rendered"];
  if (rendered["laws"].empty()) return;
  if (rendered["hand_percent"].is_null()) {
    fmt::print("  error   of the force on the hand: not known, as nothing was touched{}\n{}",
               rendered["unsettled_ticks"] > 0 ? " that could be judged" : "", unsettled_text(rendered));
  } else {
    fmt::print("  error   of the force on the hand: {}; at the worst tick {} %, mesh and time step aside\n{}",
               total_text(rendered), two_figures(rendered["hand_max_percent"].get<double>()),
               unsettled_text(rendered));
  }
  print_age(tool);
  const auto row = [&](const char* name, const char* percent, const std::string& how) {
    const std::string number =
        rendered[percent].is_null() ? "?" : two_figures(rendered[percent].get<double>());
    fmt::print("          {:<14}{:>7}   {}\n", name, number, how);
  };
  const auto source = [&](const char* of) { return rendered["how"][of].get<std::string>(); };
  row("mesh", "mesh_percent", source("mesh"));
  row("time step", "motion_percent", source("motion"));
  fmt::print("          {:<14}{:>7}   {}\n", "tissue's law", "?", law_text(tool["force"]));
  for (const HandError& error : std::span(kHandErrors).subspan(1, 4))
    row(error.name, error.key, error.how[0] == 0 ? source(error.name) : error.how);
  if (const double unjudged = percent_of_ticks(rendered, "unjudged_ticks"); unjudged > 0) {
    fmt::print(
        "          {:.3g} % of the ticks could not be judged: no sample of their session came within 0.9 s\n",
        unjudged);
  }
}

}  // namespace palpate::client
