#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/text.h"
#include "sim_server/commands/explain.h"
#include "sim_server/models/deformation_models.h"

namespace palpate::sim {
namespace {

using Row = std::vector<std::string>;

std::string bytes_text(double bytes) {
  const double size = std::abs(bytes);
  if (size < 1e3) return fmt::format("{:.0f}  B", bytes);
  if (size < 1e6) return fmt::format("{:.1f} kB", bytes / 1e3);
  if (size < 1e9) return fmt::format("{:.1f} MB", bytes / 1e6);
  return fmt::format("{:.1f} GB", bytes / 1e9);
}

std::string or_dash(const std::optional<double>& value, std::string (*text)(double)) {
  return value && *value > 0 ? text(*value) : "-";
}

std::string setup_text(double ms) {
  return fmt::format("{:.1f} ms", ms);
}

std::string step_text(double ms) {
  return fmt::format("{:.3f} ms", ms);
}

/// Columns as wide as their widest entry, two spaces apart; those from `first_right` to `last_right` are
/// numbers.
std::string table(const std::vector<Row>& rows, std::size_t first_right, std::size_t last_right) {
  std::vector<std::size_t> width(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const bool right = c >= first_right && c <= last_right;
      line += right ? fmt::format("  {:>{}}", row[c], width[c]) : fmt::format("  {:<{}}", row[c], width[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

/// Returns what stands at "FILE:LINE", with its place; or `where` itself.
std::string line_at(const std::string& where) {
  const std::size_t colon = where.rfind(':');
  int number = 0;
  if (colon == std::string::npos || std::sscanf(where.c_str() + colon + 1, "%d", &number) != 1) return where;
  std::ifstream file(where.substr(0, colon));
  std::string line;
  for (int i = 0; i < number && std::getline(file, line); ++i) {
  }
  return fmt::format("{}: {}", where, line);
}

double total_setup_ms(const Explanation& explanation) {
  double sum = 0;
  for (const BuiltPart& part : explanation.built) sum += part.setup_ms;
  return sum;
}

std::size_t total_bytes(const Explanation& explanation) {
  std::size_t sum = 0;
  for (const BuiltPart& part : explanation.built) sum += part.bytes;
  return sum;
}

std::string built_text(const Explanation& explanation) {
  std::vector<Row> rows{{"built", "", "asked for by", "holds", "set-up"}};
  for (const BuiltPart& p : explanation.built) {
    rows.push_back(
        {p.part, p.detail, p.where, bytes_text(static_cast<double>(p.bytes)), setup_text(p.setup_ms)});
  }
  const auto bytes = static_cast<double>(total_bytes(explanation));
  rows.push_back(
      {"all", fmt::format("{:.0f} bytes a tetrahedron", bytes / static_cast<double>(explanation.tetrahedra)),
       "", bytes_text(static_cast<double>(total_bytes(explanation))),
       setup_text(total_setup_ms(explanation))});
  rows.push_back({"resident", "at most, with the program and what set-up freed again: measured", "",
                  bytes_text(explanation.peak_bytes), ""});
  return table(rows, 3, 4);
}

std::string omitted_text(const Explanation& explanation) {
  std::vector<Row> rows{{"omitted", "why", "saves", "saves set-up", "saves a step", ""}};
  for (const Omitted& row : explanation.omitted) {
    rows.push_back({row.what, row.why, or_dash(row.bytes, bytes_text), or_dash(row.setup_ms, setup_text),
                    or_dash(row.step_ms, step_text), row.note});
  }
  return table(rows, 2, 4);
}

/// The rate at which one step in a hundred would just not be late; 0 when there were no steps.
double possible_rate_hz(const StepTimes& steps) {
  const double p99 = steps.contact_ns.quantile(0.99);
  return p99 > 0 ? 1e9 / p99 : 0;
}

std::string steps_text(const Explanation& explanation) {
  const StepTimes& steps = explanation.steps;
  const auto row = [](const std::string& name, const Histogram& ns) {
    return Row{name, step_text(ns.quantile(0.5) / 1e6), step_text(ns.quantile(0.99) / 1e6),
               fmt::format("{} steps", ns.count())};
  };
  const std::size_t tools = explanation.scene.tools.size();
  std::string text =
      table({{"a step takes", "median", "p99", ""},
             row(tools > 1 ? "tools free" : "tool free", steps.free_ns),
             row(tools > 1 ? fmt::format("in contact, {} tools", tools) : "in contact", steps.contact_ns)},
            1, 2);
  if (const auto wanted = steps.contact_ns.count(); steps.contacts < wanted || steps.flagged > 0) {
    text += fmt::format("  {} touched in only {} of the {} steps in contact; {} did not settle{}{}\n",
                        tools > 1 ? "all tools" : "the tool", steps.contacts, wanted, steps.flagged,
                        steps.why.empty() ? "" : ": ", steps.why);
  }
  const Scene& scene = explanation.scene;
  const std::string requested =
      scene.rate_hz > 0 ? fmt::format("{:g} Hz", scene.rate_hz) : "a step per tool state";
  text += fmt::format(
      "\n  this machine in contact: {:.0f} Hz by the median step, {:.0f} Hz by all but 1 in 100, under a "
      "press "
      "that is this command's own: a motion that slides or presses deeper may take longer steps; asked for: "
      "{} ({})\n",
      1e9 / steps.contact_ns.quantile(0.5), possible_rate_hz(steps), requested,
      scene.rate_where.empty() ? "default" : scene.rate_where);
  return text + fmt::format("  state hash after these steps: {:016x}\n", explanation.state_hash);
}

Json value_or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

Json steps_json(const Histogram& ns) {
  return {{"steps", ns.count()}, {"step_ms", quantiles(ns, 1e6)}};
}

}  // namespace

std::string to_text(const Explanation& explanation) {
  const Scene& scene = explanation.scene;
  return fmt::format("{}: \"{}\", model {}\n\n{}\n{}\n{}", scene.source, scene.title, scene.deformation.model,
                     built_text(explanation), omitted_text(explanation), steps_text(explanation));
}

std::string why_text(const Explanation& explanation, const std::string& part) {
  std::vector<std::string> known;
  for (const BuiltPart& row : explanation.built) {
    known.push_back(row.part);
    if (row.part != part) continue;
    return fmt::format("{} is built: {}\n  asked for by {}\n  holds {}, set-up {}\n", part, row.detail,
                       line_at(row.where), bytes_text(static_cast<double>(row.bytes)),
                       setup_text(row.setup_ms));
  }
  for (const Omitted& row : explanation.omitted) {
    known.push_back(row.what);
    if (row.what != part) continue;
    return fmt::format("{} is omitted\n  by {}\n  saves {}, set-up {}, a step {} ({})\n", part,
                       line_at(row.why), or_dash(row.bytes, bytes_text), or_dash(row.setup_ms, setup_text),
                       or_dash(row.step_ms, step_text), row.note);
  }
  fail_unknown_name(part, "part", "--why", known);
}

Json to_json(const Explanation& explanation) {
  const Scene& scene = explanation.scene;
  Json built = Json::array(), omitted = Json::array();
  for (const BuiltPart& p : explanation.built) {
    built.push_back({{"part", p.part},
                     {"detail", p.detail},
                     {"where", p.where},
                     {"bytes", p.bytes},
                     {"setup_ms", p.setup_ms}});
  }
  for (const Omitted& row : explanation.omitted) {
    omitted.push_back({{"what", row.what},
                       {"why", row.why},
                       {"bytes", row.bytes ? Json(std::llround(*row.bytes)) : Json()},
                       {"setup_ms", value_or_null(row.setup_ms)},
                       {"step_ms", value_or_null(row.step_ms)},
                       {"note", row.note}});
  }
  Json contact = steps_json(explanation.steps.contact_ns);
  contact["touching"] = explanation.steps.contacts;
  contact["flagged"] = explanation.steps.flagged;
  return {{"scene", scene.source},
          {"title", scene.title},
          {"model", scene.deformation.model},
          {"rate_hz", scene.rate_hz},
          {"rate_where", scene.rate_where},
          {"possible_rate_hz", possible_rate_hz(explanation.steps)},
          {"bytes", total_bytes(explanation)},
          {"peak_bytes", std::llround(explanation.peak_bytes)},
          {"setup_ms", total_setup_ms(explanation)},
          {"built", built},
          {"omitted", omitted},
          {"free", steps_json(explanation.steps.free_ns)},
          {"contact", contact},
          {"bytes_per_tetrahedron",
           static_cast<double>(total_bytes(explanation)) / static_cast<double>(explanation.tetrahedra)},
          {"state_hash", fmt::format("{:016x}", explanation.state_hash)}};
}

std::string list_of_models() {
  return "Models ([deformation] model):\n" + help_rows(deformation_models());
}

Command explain_command() {
  const auto options = std::make_shared<ExplainOptions>();
  return {
      .name = "explain",
      .summary = "What a scene builds, what it leaves out, and what that saves",
      .footer = list_of_models() +
                "Examples:\n"
                "  sim_server explain configs/scenes/liver.toml --json explain.json\n"
                "  sim_server explain configs/scenes/liver.toml --why compliance",
      .options = joined(
          {{{"SCENE", "Scene file (TOML)", &options->scene, {.required = true}},
            {"--json", "Write the same to this JSON file", &options->json}},
           cache_options(options->cache),
           {{"--why",
             "Only this part, built or omitted: which line of the scene says so, and what it costs or saves",
             &options->why,
             {.value_name = "PART"}},
            {"--steps",
             "How many steps to time, free of the organ and in contact each",
             &options->steps,
             {.shows_default = true}}}}),
      .run = [options] {
        require_within(options->steps, 1, 100000, "--steps", "steps");
        return run_explain(*options);
      }};
}

}  // namespace palpate::sim
