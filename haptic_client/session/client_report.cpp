#include "haptic_client/session/client_report.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/text.h"
#include "haptic_client/evaluation/law_cost.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/session/whole_error.h"
#include "protocol/link_report.h"

namespace palpate::client {
namespace {

double per(double sum, double count) {
  return count > 0 ? sum / count : 0;
}

Json substitutes_report(const Substitutes& substitutes) {
  Json laws = Json::object();
  for (const auto& [law, ticks] : substitutes.rows()) {
    if (ticks > 0) laws[std::string(law)] = ticks;
  }
  return laws;
}

/// Returns which law was really at work where `law` was asked for: the one of most ticks, and each one's
/// share of them, the largest first. Empty before the first sample.
Json at_work_report(const std::string& law, const Substitutes& substitutes, std::uint64_t ticks) {
  std::vector<std::pair<std::uint64_t, std::string>> laws{{ticks, law}};
  for (const auto& [name, stood_in] : substitutes.rows()) {
    if (stood_in == 0) continue;
    laws.front().first -= std::min(stood_in, laws.front().first);
    laws.emplace_back(stood_in, name);
  }
  std::ranges::stable_sort(laws, [](const auto& a, const auto& b) { return a.first > b.first; });
  Json report = {{"law", ticks > 0 ? laws.front().second : ""}, {"laws", Json::object()}};
  for (const auto& [rendered, name] : laws) {
    if (rendered > 0) report["laws"][name] = per(static_cast<double>(rendered), static_cast<double>(ticks));
  }
  return report;
}

bool knows_surface(const std::string& law) {
  return find_row(extrapolators(), law, "law", "report").make()->request().surface;
}

Json methods_report(const Scoring& scoring) {
  Json methods = Json::object();
  for (std::size_t i = 0; i < scoring.names().size(); ++i) {
    Json method = to_json(scoring.metrics(i));
    method["ticks"] = scoring.ticks();
    method["at_work"] = at_work_report(scoring.names()[i], scoring.substitutes(i), scoring.ticks());
    method["stand_ins"] = substitutes_report(scoring.substitutes(i));
    // Of a law that knows the surface, only with one: `evaluate` measures it.
    method["ns_per_tick"] =
        knows_surface(scoring.names()[i]) ? Json() : Json(cost_of(scoring.names()[i]).tick_ns);
    methods[scoring.names()[i]] = std::move(method);
  }
  return methods;
}

/// Returns what the laws were held against: the force between samples, of most ticks, and each kind's share.
Json reference_report(const Scoring& scoring) {
  Json report = {{"name", name_of(scoring.mostly_between())}};
  for (const auto kind : {ReferenceKind::kContact, ReferenceKind::kHermite, ReferenceKind::kLine}) {
    report["fractions"][std::string(name_of(kind))] =
        per(static_cast<double>(scoring.between(kind)), static_cast<double>(scoring.scored()));
  }
  return report;
}

Json timeline_report(const SessionTimeline& timeline, const Scoring& scoring) {
  Json cells = Json::array();
  for (std::size_t i = 0; i < timeline.size(); ++i) {
    const SessionCell& cell = timeline[i];
    Json errors = Json::object();
    const double rms = std::sqrt(per(cell.errors.reference_squared, cell.errors.contact));
    for (std::size_t law = 0; law < scoring.names().size(); ++law) {
      errors[scoring.names()[law]] =
          rms > 0 ? Json(100 * per(per(cell.errors.error[law], cell.errors.contact), rms)) : Json();
    }
    cells.push_back({{"t_s", static_cast<double>(i) * to_seconds(timeline.width())},
                     {"ticks", cell.ticks},
                     {"missed", cell.missed},
                     {"tick_us_mean", 1e-3 * per(cell.tick_ns_sum, cell.ticks)},
                     {"tick_us_max", 1e-3 * cell.tick_ns_max},
                     {"samples", cell.samples},
                     {"step_ms_mean", 1e-6 * per(cell.step_ns_sum, cell.samples)},
                     {"step_ms_max", 1e-6 * cell.step_ns_max},
                     {"contact_ticks", cell.errors.contact},
                     {"error_percent", errors}});
  }
  return {{"cell_s", to_seconds(timeline.width())}, {"cells", cells}};
}

/// Mean over the cells [from, to) of what `value` says of each, weighted by `weight`; NaN: there is none.
double mean_over(const Json& cells, std::size_t from, std::size_t to, const char* weight, auto value) {
  double sum = 0, count = 0;
  for (std::size_t i = from; i < to; ++i) {
    const double w = cells[i][weight].template get<double>();
    sum += w * value(cells[i]);
    count += w;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

/// "-" of what was not measured.
std::string two_decimals(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.2f}", value);
}

void print_drift(const Json& tool) {
  const Json& cells = tool["timeline"]["cells"];
  const std::size_t n = cells.size(), part = n / 4;
  if (part == 0) return;
  const auto drift = [&](const char* weight, auto value) {
    return fmt::format("{} -> {}", two_decimals(mean_over(cells, 0, part, weight, value)),
                       two_decimals(mean_over(cells, n - part, n, weight, value)));
  };
  const auto column = [](const char* key) {
    return [key](const Json& cell) { return cell[key].get<double>(); };
  };
  std::string text;
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  if (mean_over(cells, 0, n, "ticks", column("tick_us_mean")) > 0)
    add(fmt::format("tick {} us", drift("ticks", column("tick_us_mean"))));
  if (mean_over(cells, 0, n, "samples", column("step_ms_mean")) > 0)
    add(fmt::format("step {} ms", drift("samples", column("step_ms_mean"))));
  const auto method = tool["method"].get<std::string>();
  if (tool["methods"].contains(method)) {
    add(fmt::format("error {} %", drift("contact_ticks", [&](const Json& cell) {
                      const Json& error = cell["error_percent"][method];
                      return error.is_null() ? 0 : error.get<double>();
                    })));
  }
  if (!text.empty()) fmt::print("  drift   first to last quarter: {}\n", text);
}

bool chooses(const std::string& law) {
  return find_row(extrapolators(), law, "method", "report").chooses;
}

/// "two_tangents stood in for local_contact in 300 ticks, learned_stiffness in 2"; of a law that chooses,
/// "best_recent was two_tangents in 300 ticks".
std::string substitutes_text(const Json& substitutes, const std::string& law) {
  std::string text;
  for (const auto& [name, ticks] : substitutes.items()) {
    if (!text.empty()) {
      text += fmt::format(", {} in {}", name, ticks.get<long>());
    } else if (chooses(law)) {
      text = fmt::format("{} was {} in {} ticks", law, name, ticks.get<long>());
    } else {
      text = fmt::format("{} stood in for {} in {} ticks", name, law, ticks.get<long>());
    }
  }
  return text;
}

/// 99.75 of 99.7512 %, and never 100 of less than all.
std::string percent_text(double fraction) {
  return fraction < 1 ? fmt::format("{:.4g} %", std::min(100 * fraction, 99.99)) : "100 %";
}

/// The law that was really at work in most ticks of the row of another, in brackets.
std::string row_name(const std::string& law, const Json& scores) {
  const auto at_work = scores["at_work"]["law"].get<std::string>();
  if (at_work.empty() || at_work == law) return law;
  const double fraction = scores["at_work"]["laws"][at_work].get<double>();
  return fmt::format("{} (as {} {})", law, at_work, percent_text(fraction));
}

/// "two_tangents 99.75 %, local_contact 0.25 % (asked for: local_contact)".
std::string rendered_text(const Json& tool) {
  const auto method = tool["method"].get<std::string>();
  std::string text;
  for (const auto& [name, fraction] : tool["rendered"]["laws"].items())
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, percent_text(fraction.get<double>()));
  if (text.empty()) return fmt::format("nothing; asked for: {}", method);
  if (tool["rendered"]["law"] == method) return text;
  if (chooses(method)) return fmt::format("{} ({})", text, method);
  return fmt::format("{} (asked for: {})", text, method);
}

void print_substitutes(const Json& methods) {
  for (const auto& [name, scores] : methods.items()) {
    if (scores["stand_ins"].empty()) continue;
    fmt::print("          {} of {}{}\n", substitutes_text(scores["stand_ins"], name),
               scores["ticks"].get<long>(),
               chooses(name) ? "" : ": what the samples brought was not enough for more");
  }
}

/// "contact 98 %, hermite 2 %".
std::string reference_text(const Json& reference) {
  std::string text;
  for (const auto& [name, fraction] : reference["fractions"].items()) {
    if (fraction.get<double>() > 0)
      text += fmt::format("{}{} {:.3g} %", text.empty() ? "" : ", ", name, 100 * fraction.get<double>());
  }
  return text.empty() ? "none yet" : text;
}

struct ScoreColumn {
  const char* key;
  int width, decimals;
};
constexpr std::array<ScoreColumn, 11> kScoreColumns{{{"mean_percent", 10, 3},
                                                     {"p99_of_rms_percent", 10, 2},
                                                     {"max_of_rms_percent", 10, 2},
                                                     {"p99_percent", 10, 3},
                                                     {"max_percent", 10, 2},
                                                     {"mean_10ms_percent", 13, 3},
                                                     {"p99_10ms_of_rms_percent", 10, 2},
                                                     {"max_10ms_of_rms_percent", 10, 2},
                                                     {"paper_mean_percent", 13, 3},
                                                     {"paper_max_percent", 10, 1},
                                                     {"paper_max_force_percent", 10, 1}}};

void print_scores(const Json& tool) {
  const Json &methods = tool["methods"], &motion = tool["motion"];
  if (methods.empty()) return;
  fmt::print(
      "  score   {} ticks against the force between the samples ({}), latency included; {:.1f} samples a "
      "second\n",
      tool["scored_ticks"].get<long>(), reference_text(tool["reference"]),
      motion["sample_rate_hz"].get<double>());
  if (std::isnan(methods.begin().value()["mean_percent"].get<double>())) {
    fmt::print("          nothing was touched, so that no law can be wrong\n");
    return print_substitutes(methods);
  }
  std::size_t width = 0;
  for (const auto& [name, m] : methods.items()) width = std::max(width, row_name(name, m).size());
  fmt::print("          {:{}}{:>30}{:>20}   {:>30}   {:>30}   {:>7}\n", "", width, "error, % of RMS",
             "% of peak", "of means over 10 ms, % of RMS", "paper: % of force on the line", "");
  fmt::print(
      "          {:{}}{:>10}{:>10}{:>10}{:>10}{:>10}   {:>10}{:>10}{:>10}   {:>10}{:>10}{:>10}   {:>7}\n",
      "law", width, "mean", "p99", "max", "p99", "max", "mean", "p99", "max", "average", "maximal",
      "max force", "ns/tick");
  for (const auto& [name, m] : methods.items()) {
    std::string line = fmt::format("          {:{}}", row_name(name, m), width);
    for (const ScoreColumn& column : kScoreColumns) {
      const auto value = m[column.key].get<double>();  // NaN of means over 10 ms, where a tick is as long
      line += fmt::format("{:>{}}", std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, column.decimals),
                          column.width);
    }
    fmt::print("{}   {:>7}\n", line,
               m["ns_per_tick"].is_null() ? "-" : fmt::format("{:.1f}", m["ns_per_tick"].get<double>()));
  }
  print_substitutes(methods);
}

void print_loop(const Json& loop) {
  const auto number = [](const Json& group, const char* key) { return group[key].get<double>(); };
  const Json &period = loop["period_us"], &tick = loop["tick_us"];
  const double due = number(loop, "ticks") + number(loop, "missed");
  fmt::print(
      "  loop    {:g} Hz, {:.0f} ticks, {:.0f} missed ({:.2f} % on time); period {:.0f} us (p50), {:.0f} "
      "(p99), {:.0f} (max); a tick takes {:.1f} us (p50), {:.1f} (p99)\n",
      number(loop, "rate_hz"), number(loop, "ticks"), number(loop, "missed"),
      due > 0 ? 100 * number(loop, "ticks") / due : 0, number(period, "p50"), number(period, "p99"),
      number(period, "max"), number(tick, "p50"), number(tick, "p99"));
}

void print_tool(const Json& tool) {
  const auto number = [](const Json& group, const char* key) { return group[key].get<double>(); };
  const Json &force = tool["force"], &motion = tool["motion"], &safety = tool["safety"],
             &age = force["age_ms"];
  fmt::print(
      "  force   {:.0f} samples, age {:.1f} ms (p50), {:.1f} (p99), {:.1f} (max); largest force {:.2f} N\n",
      number(force, "samples"), number(age, "p50"), number(age, "p99"), number(age, "max"),
      number(force, "max_newton"));
  if (const auto jumps = jumps_in(force, "unexplained_jump"))
    fmt::print("          {}\n", unexplained_text(*jumps));
  if (number(force, "wild") > 0) {
    fmt::print(
        "          {:.0f} samples were dropped: over 100 times the largest force, which no tissue makes\n",
        number(force, "wild"));
  }
  if (number(force, "strained") > 0) {
    fmt::print(
        "          {:.0f} samples ({:.3g} %) were of tissue strained beyond what its law is meant for: the "
        "server's report says by how much\n",
        number(force, "strained"), 100 * per(number(force, "strained"), number(force, "samples")));
  }
  if (number(force, "flagged") > 0) {
    fmt::print(
        "          {:.0f} samples were flagged by the server as not settled; {:.0f} ticks faded for that "
        "reason\n",
        number(force, "flagged"), number(safety, "unsettled"));
  }
  if (!force["stand_ins"].empty() || number(force, "surface_pages") > 0) {
    fmt::print("  law     {}; {:.0f} pages of the surface came\n",
               !force["stand_ins"].empty()
                   ? substitutes_text(force["stand_ins"], tool["method"].get<std::string>())
                   : "itself in all ticks",
               number(force, "surface_pages"));
  }
  fmt::print("  motion  {:.4f} m/s mean, {:.4f} max; {:.2f} mm between samples\n",
             number(motion, "mean_speed_m_s"), number(motion, "max_speed_m_s"),
             number(motion, "spatial_sampling_mm"));
  fmt::print(
      "  safety  ticks: {:.0f} clamped, {:.0f} slewed, {:.0f} damped, {:.0f} softened, {:.0f} without "
      "device, {:.0f} "
      "clutched; times: {:.0f} faded, {:.0f} not finite, {:.0f} storms, {:.0f} wild\n",
      number(safety, "clamped"), number(safety, "slewed"), number(safety, "damped"),
      number(safety, "softened"), number(safety, "lost"), number(safety, "clutched"),
      number(safety, "ramped"), number(safety, "not_finite"), number(safety, "storms"),
      number(safety, "implausible"));
  if (safety.value("cut_by_motors", 0) > 0) {
    fmt::print("          {:.0f} ticks: the motors of the device could not give the whole force\n",
               number(safety, "cut_by_motors"));
  }
}

/// Says what a slow link left out. The first second of each session is packed.
void print_levels(const Json& levels) {
  constexpr std::array<std::pair<LinkLevel, const char*>, 3> kSlow{
      {{LinkLevel::kPlain, "ticks packed and few pages"},
       {LinkLevel::kLean, "samples with tangents alone and no pages"},
       {LinkLevel::kSparse, "about a tick a step, and samples without parts"}}};
  double all = 0, packed = levels[name_of(LinkLevel::kPacked)].get<double>();
  for (const auto& [name, seconds] : levels.items()) all += seconds.get<double>();
  std::string text;
  const auto add = [&](double seconds, const char* what) {
    if (seconds > 0.01 * all)
      text += fmt::format("{}{:.0f} % of the time {}", text.empty() ? "" : ", ", 100 * seconds / all, what);
  };
  add(packed > 2 ? packed : 0, "ticks packed");
  for (const auto& [level, what] : kSlow) add(levels[name_of(level)].get<double>(), what);
  if (!text.empty())
    fmt::print("  slow    the link is slow, so that less travelled: {}; 2 Mbit/s each way carry all of it\n",
               text);
}

void print_link(const Json& link) {
  print_levels(link["levels_s"]);
  if (link.value("drops_large", false)) fmt::print("  narrow  {}\n", large_datagrams_text());
  fmt::print("  link   ");
  const char* separator = " ";
  for (const auto& [name, count] : link.items()) {
    if (!count.is_number_integer() || name.starts_with("bytes")) continue;  // the counters
    fmt::print("{}{} {}", separator, count.get<long>(), name);
    separator = ", ";
  }
  for (const auto& [reason, count] : link["rejected_by"].items())
    fmt::print(", {} by {}", count.get<long>(), reason);
  fmt::print("\n");
}

}  // namespace

const char* name_of(Fault fault) {
  switch (fault) {
    case Fault::kNone:
      return "none";
    case Fault::kNotFinite:
      return "a force was not finite";
    case Fault::kExcessive:
      return "for half a second a force was asked for that no tissue makes, over 100 times the limit";
    case Fault::kStorm:
      return "the force oscillated against the slew limit";
  }
  return "unknown";
}

Json tool_report(const ClientConfig& config, const Pipeline& pipeline, const Observation& observation) {
  const PipelineStats& stats = pipeline.stats();
  const LimiterCounts& limiter = pipeline.limiter().counts();
  const auto pairs = static_cast<double>(stats.sample_pairs);
  Json rendered = at_work_report(config.method, stats.substitutes, stats.published);
  rendered.update(whole_error_report(observation));
  Json force = {{"samples", stats.samples},
                {"overtaken", stats.overtaken},
                {"flagged", stats.flagged},
                {"wild", stats.wild},
                {"strained", stats.strained},
                {"stepped_down", stats.stepped_down},
                {"stand_ins", substitutes_report(stats.substitutes)},
                {"surface_pages", stats.pages},
                {"age_ms", quantiles(stats.age_ns, 1e6)},
                {"max_newton", stats.max_newton}};
  add_to(force, "unexplained_jump", observation.scoring().unexplained_jumps());
  return {{"device", config.device.name},
          {"port", config.device.port},
          {"method", config.method},
          {"rendered", rendered},
          {"force", std::move(force)},
          {"motion",
           {{"mean_speed_m_s", per(stats.path_m, stats.path_s)},
            {"max_speed_m_s", stats.max_speed},
            {"sample_rate_hz", per(pairs, stats.sample_path_s)},
            {"spatial_sampling_mm", 1e3 * per(stats.sample_path_m, pairs)}}},
          {"safety",
           {{"clamped", limiter.clamped},
            {"slewed", limiter.slewed},
            {"damped", pipeline.passivity().counts().damped},
            {"softened", pipeline.passivity().counts().softened},
            {"least_gain", pipeline.passivity().counts().least_gain},
            {"weak_s", pipeline.rendered_fraction().total_s()},
            {"largest_debt_mj", 1e3 * pipeline.passivity().counts().largest_debt_j},
            {"ramped", pipeline.watchdog().ramped()},
            {"unsettled", stats.unsettled},
            {"lost", stats.lost},
            {"clutched", stats.clutched},
            {"not_finite", limiter.not_finite},
            {"storms", limiter.storms},
            {"implausible", limiter.implausible}}},
          {"scored_ticks", observation.scoring().scored()},
          {"reference", reference_report(observation.scoring())},
          {"methods", methods_report(observation.scoring())},
          {"timeline", timeline_report(observation.timeline(), observation.scoring())}};
}

Json loop_report(double rate_hz, const HapticLoopStats& stats) {
  return {{"rate_hz", rate_hz},
          {"ticks", stats.ticks},
          {"missed", stats.missed},
          {"unsent", stats.unsent},
          {"period_us", quantiles(stats.period_ns, 1e3)},
          {"tick_us", quantiles(stats.tick_ns, 1e3)}};
}

Json link_report(const NetLink& link) {
  const LinkFigures& figures = link.figures();
  Json report = protocol::link_report(link.stats());
  report["age_ms"] = quantiles(figures.age_ns, 1e6);
  report["bytes_up"] = figures.bytes_up;
  report["bytes_down"] = figures.bytes_down;
  report["bytes_down_first_second"] = figures.early_bytes_down;
  report["stiffest_n_m"] = figures.stiffest;
  report["uplink"] = {{"came", figures.uplink.came}, {"lost", figures.uplink.lost}};
  report["levels_s"] = Json::object();
  for (std::size_t i = 0; i < kLinkLevels; ++i)
    report["levels_s"][name_of(static_cast<LinkLevel>(i))] = to_seconds(link.pace().spent()[i]);
  return report;
}

void print_report(const Json& report) {
  for (const Json& tool : report["tools"]) {
    fmt::print("haptic_client: {}, rendered: {}\n", tool["device"].get<std::string>(), rendered_text(tool));
    print_whole_error(tool);
    if (tool.contains("loop")) print_loop(tool["loop"]);
    print_tool(tool);
    print_scores(tool);
    print_drift(tool);
    if (tool.contains("link")) print_link(tool["link"]);
    if (tool.contains("recording")) {
      const Json& recording = tool["recording"];
      fmt::print("  record  {} packets in {}, {} dropped\n", recording["packets"].get<long>(),
                 recording["file"].get<std::string>(), recording["dropped"].get<long>());
    }
  }
  std::fflush(stdout);
}

}  // namespace palpate::client
