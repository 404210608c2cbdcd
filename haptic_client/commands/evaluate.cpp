#include "haptic_client/commands/evaluate.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/error.h"
#include "common/log.h"
#include "common/progress.h"
#include "common/report.h"
#include "common/text.h"
#include "haptic_client/commands/overrides.h"
#include "haptic_client/evaluation/captured_session.h"
#include "haptic_client/evaluation/law_cost.h"
#include "haptic_client/evaluation/scaled_compliance.h"
#include "haptic_client/evaluation/scoring.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "protocol/scene_print.h"

namespace palpate::client {
namespace {

// 9: tool, version and number of a page.
constexpr double kPageBytes = protocol::kHeaderBytes + 9 + 4 * protocol::SurfacePage::kValues;

/// The description of a capture, and the scores of the laws on it, plain and blended.
struct Evaluation {
  double ticks_hz = 0, path = 0, seconds = 0, age = 0;  // Hz, m, s, s: a sum over samples
  std::vector<double> bytes;                            // of each law: a sum over samples
  std::size_t run = 0;                                  // of the capture
  double model_bytes = 0;                               // of the surface, once
  std::uint64_t samples = 0;
  std::vector<Scoring> plain, blended;  // at most kMaxLaws laws each
};

std::vector<Scoring> scorings(const std::vector<std::string>& laws, double ticks_hz, double blend,
                              const Truth* truth) {
  std::vector<Scoring> all;
  for (std::size_t i = 0; i < laws.size(); i += kMaxLaws) {
    const auto end = laws.begin() + static_cast<std::ptrdiff_t>(std::min(i + kMaxLaws, laws.size()));
    all.emplace_back(std::vector(laws.begin() + static_cast<std::ptrdiff_t>(i), end), ticks_hz, "--method",
                     blend, truth);
  }
  return all;
}

/// The rate that was meant: captured ticks come at whole microseconds.
double ticks_per_second(const CapturedRun& run) {
  return std::clamp(std::round(run.ticks_hz()), 1.0, 20000.0);
}

Request request_of(const std::string& law) {
  return find_row(extrapolators(), law, "method", "--method").make()->request();
}

/// Returns the bytes of a sample without the parts that the law has no use for.
double bytes_for(const Request& request, protocol::ForceSample sample) {
  if (!request.at_tool) sample.flags &= ~protocol::ForceSample::kHasTangent;
  if (!request.ahead) sample.flags &= ~protocol::ForceSample::kHasAhead;
  if (!request.surface)
    sample.flags &= ~(protocol::ForceSample::kHasSurface | protocol::ForceSample::kHasModes |
                      protocol::ForceSample::kHasRelaxed | protocol::ForceSample::kHasModalLoads);
  sample.flags &= ~protocol::ForceSample::kHasErrors;  // for reports, not for laws
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  return static_cast<double>(protocol::encode({}, sample, bytes));
}

/// An evaluation of the longest run of a capture, before its first tick.
Evaluation start_evaluation(const CaptureSurvey& found, const std::vector<std::string>& laws,
                            const EvaluateOptions& options, const Truth* truth) {
  const auto longest =
      std::ranges::max_element(found.runs, [](const auto& a, const auto& b) { return a.ticks < b.ticks; });
  Evaluation e;
  e.bytes.resize(laws.size());
  e.run = static_cast<std::size_t>(longest - found.runs.begin());
  e.ticks_hz = ticks_per_second(*longest);
  e.plain = scorings(laws, e.ticks_hz, 0, truth);
  e.plain.front().judge_between_samples();
  e.blended = scorings(laws, e.ticks_hz, options.blend_ms / 1e3, truth);
  return e;
}

/// The surface as laws know it by now.
struct KnownSurface {
  SurfaceModel model;
  protocol::SurfacePages pages;
};

/// The pages that a tick was the first to have. `compliance`: how many times as compliant as it was sent laws
/// see the surface.
void take_pages(const CapturedTick& tick, double compliance, KnownSurface& surface, Evaluation& e) {
  for (const protocol::SurfacePage& page : tick.pages)
    surface.model.take(with_scaled_compliance(page, surface.pages, compliance));
  e.model_bytes += kPageBytes * static_cast<double>(tick.pages.size());
}

/// The sample that arrived in a tick, as laws get it; its age, and its bytes for each law by what that wants,
/// are added to those before.
std::optional<Sample> take_sample(const CapturedTick& tick, const std::vector<Request>& request,
                                  KnownSurface& surface, Evaluation& e) {
  if (!tick.arrived) return {};
  const protocol::SurfaceState& state = tick.arrived->surface;
  if (state.version != 0) surface.pages = {state.vertices, state.triangles};
  const Sample sample = sample_of(*tick.arrived, &surface.model);
  ++e.samples;
  e.age += to_seconds(Time{tick.state.t_ns} - sample.t);
  for (std::size_t i = 0; i < request.size(); ++i) e.bytes[i] += bytes_for(request[i], *tick.arrived);
  return sample;
}

/// How far the tool was, at most, from where that of the truth was at the same time, m; and how many samples
/// there were, and at how many of their times there is no truth.
struct FromTruth {
  const Truth* truth;
  double most = 0;
  std::uint64_t samples = 0, without = 0;
  void add(const Sample& sample) {
    if (truth == nullptr) return;
    const std::optional<double> apart = truth->distance(sample.p, sample.t);
    ++samples;
    without += apart ? 0 : 1;
    most = std::max(most, apart.value_or(0));
  }
};

/// That the truth is of the whole of it: what it leaves out would not be scored.
void require_same_span(const FromTruth& from, const std::filesystem::path& file,
                       const EvaluateOptions& options) {
  constexpr double kMissing = 0.05;  // of the samples
  if (static_cast<double>(from.without) <= kMissing * static_cast<double>(from.samples)) return;
  if (from.without == from.samples) {
    fail(
        "{}: no sample of it is of a time that --truth {} knows: a session of another clock, or begun at "
        "another time; record both with `sim_server record` and the same --trajectory",
        file.string(), options.truth->string());
  }
  fail(
      "{}: --truth {} ends before it, or begins later: it knows the time of {:.0f} % of the samples, and the "
      "others would not be scored; record the truth over the whole motion, or this capture with --seconds",
      file.string(), options.truth->string(),
      100 * static_cast<double>(from.samples - from.without) / static_cast<double>(from.samples));
}

/// That both captures are of one motion: the line between two samples of a truth is off by micrometres.
void require_same_motion(const FromTruth& from, const std::filesystem::path& file,
                         const EvaluateOptions& options) {
  constexpr double kSame = 1e-4;  // m
  if (from.most <= kSame) return;
  fail(
      "{}: its tool is up to {:.3g} mm away from that of --truth {} at the same time: another motion, or "
      "begun at "
      "another time; record both with the same --trajectory",
      file.string(), 1e3 * from.most, options.truth->string());
}

/// That both captures are of one scene, where both tell of which they are.
void require_same_scene(const CapturedRun& run, const Truth& truth, const std::filesystem::path& file,
                        const EvaluateOptions& options) {
  const auto is_of_another = [&](const CapturedLink& link) {
    return link.scene && truth.scene() && *link.scene != *truth.scene();
  };
  const auto other = std::ranges::find_if(run.links, is_of_another);
  if (other == run.links.end()) return;
  fail(
      "{}: is of another scene than --truth {}, which differs by: {}; record the truth again, of the scene "
      "of "
      "the capture: `sim_server record SCENE --trajectory MOTION --rate 2000 --plain --out {}`",
      file.string(), options.truth->string(), protocol::differences(*other->scene, *truth.scene()),
      options.truth->string());
}

void require_scored(const Evaluation& e, const std::filesystem::path& file) {
  if (e.samples < 2 || !(e.seconds > 0))
    fail("{}: has fewer than two force samples; nothing to evaluate", file.string());
  if (e.plain.front().scored() == 0)
    fail(
        "{}: no two force samples are near enough in time to score what lies between; a smaller --keep, or a "
        "faster capture",
        file.string());
}

Evaluation run(const std::filesystem::path& file, const std::vector<std::string>& laws,
               const EvaluateOptions& options, const Truth* truth, ProgressLine& progress) {
  const CaptureSurvey found = survey(file, [](double) {});
  if (!found.trouble.empty())
    log::warning("{}: {}; what was read until then is evaluated", file.string(), found.trouble);
  Evaluation e = start_evaluation(found, laws, options, truth);
  if (truth != nullptr) require_same_scene(found.runs[e.run], *truth, file, options);
  CapturedSession session(file, e.run);
  std::optional<protocol::ToolState> before;
  ErrorSums ignored;
  KnownSurface surface;
  FromTruth from_truth{truth};
  std::vector<Request> request;
  for (const std::string& law : laws) request.push_back(request_of(law));
  for (CapturedTick tick; session.next(tick);) {
    const Time t{tick.state.t_ns};
    if (tick.arrived && (tick.arrived->number - 1) % options.keep != 0) tick.arrived.reset();
    take_pages(tick, options.compliance, surface, e);
    const std::optional<Sample> sample = take_sample(tick, request, surface, e);
    if (sample) from_truth.add(*sample);
    for (auto* all : {&e.plain, &e.blended}) {
      for (Scoring& scoring : *all) scoring.tick(tick.state.p_W, t, sample ? &*sample : nullptr, ignored);
    }
    if (before) {
      e.path += (tick.state.p_W - before->p_W).norm();
      e.seconds += to_seconds(t - Time{before->t_ns});
    }
    before = tick.state;
    if (tick.state.tick % 4096 == 0) progress(file.filename().string(), session.fraction());
  }
  progress(file.filename().string(), 1);
  require_same_motion(from_truth, file, options);
  require_same_span(from_truth, file, options);
  require_scored(e, file);
  return e;
}

Json row_of(const Scoring& scoring, std::size_t law, const LawCost& cost) {
  Json row = to_json(scoring.metrics(law));
  row["energy_percent"] = scoring.energy_percent(law);
  row["ns_per_tick"] = cost.tick_ns;
  row["ns_per_tick_p99"] = cost.tick_p99_ns;
  row["ns_per_arrival"] = cost.arrival_ns;
  return row;
}

/// Null where they were not measured, as all rows of a table have the same keys.
void add_jumps(Json& row, const std::string& name, const std::optional<ForceJumps>& jumps) {
  row.update({{name + "s", nullptr}, {"largest_" + name + "_percent", nullptr}});
  add_to(row, name, jumps);
}

void add_rows(Json& rows, const std::string& world, const Evaluation& e, const Truth* truth,
              const std::vector<LawCost>& costs) {
  const bool with_truth = truth != nullptr;
  const std::optional<ForceJumps> snaps = with_truth ? truth->snaps() : std::nullopt;
  const std::string between(name_of(e.plain.front().mostly_between()));
  const ErrorMetrics own = e.plain.front().between_metrics();
  for (const bool blended : {false, true}) {
    std::size_t number = 0;
    for (const Scoring& scoring : blended ? e.blended : e.plain) {
      for (std::size_t law = 0; law < scoring.names().size(); ++law) {
        const auto samples = static_cast<double>(e.samples);
        Json row = {{"world", world},
                    {"speed_m_s", e.path / e.seconds},
                    {"rate_hz", samples / e.seconds},
                    {"delay_ms", 1e3 * e.age / samples},
                    {"reference", with_truth ? "truth" : between},
                    {"method", scoring.names()[law]},
                    {"blended", blended}};
        row.update(row_of(scoring, law, costs[number]));
        row["bytes_per_sample"] = e.bytes[number] / samples;
        row["model_bytes"] = request_of(scoring.names()[law]).surface ? e.model_bytes : 0;
        row["between"] = between;
        const auto beside_truth = [with_truth](double percent) {
          return with_truth ? Json(percent) : Json();
        };
        row["between_mean_percent"] = beside_truth(own.mean_percent);
        row["between_p99_percent"] = beside_truth(own.p99_percent);
        row["between_max_percent"] = beside_truth(own.max_percent);
        add_jumps(row, "snap", snaps);
        add_jumps(row, "unexplained_jump", scoring.unexplained_jumps());
        ++number;
        rows.push_back(row);
      }
    }
  }
}

/// Prints the reference of the rows from `begin` on.
void print_reference(const Json& rows, std::size_t begin) {
  const Json& row = rows[begin];
  const auto number = [&](const char* key) { return row[key].get<double>(); };
  fmt::print("{}: reference {}", row["world"].get<std::string>(), row["reference"].get<std::string>());
  if (row["reference"] == "truth")
    fmt::print(
        "; the force between samples ({}), which a session has instead, is off by {:.4f} % mean, {:.3f} p99, "
        "{:.2f} max",
        row["between"].get<std::string>(), number("between_mean_percent"), number("between_p99_percent"),
        number("between_max_percent"));
  fmt::print("\n");
  if (const auto snaps = jumps_in(row, "snap")) fmt::print("  {}\n", snaps_text(*snaps));
  if (const auto jumps = jumps_in(row, "unexplained_jump")) fmt::print("  {}\n", unexplained_text(*jumps));
}

void print(const Json& rows) {
  struct Column {
    const char *group, *head, *key;
    int decimals;
  };
  constexpr std::array<Column, 13> kColumns{{{"error, %", "mean", "mean_percent", 3},
                                             {"of RMS", "p99", "p99_of_rms_percent", 2},
                                             {"", "max", "max_of_rms_percent", 2},
                                             {"of peak", "p99", "p99_percent", 2},
                                             {"", "max", "max_percent", 2},
                                             {"mean over", "mean", "mean_10ms_percent", 3},
                                             {"10 ms, %", "p99", "p99_10ms_of_rms_percent", 2},
                                             {"of RMS", "max", "max_10ms_of_rms_percent", 2},
                                             {"% of peak", "over", "overshoot_percent", 2},
                                             {"", "jump", "jump_percent", 2},
                                             {"", "rough", "rough_percent", 3},
                                             {"energy", "%", "energy_percent", 2},
                                             {"time", "ns/tick", "ns_per_tick", 1}}};
  std::string groups = fmt::format("{:20} {:24} {:>5}", "", "", ""),
              heads = fmt::format("{:20} {:24} {:>5}", "world", "law", "blend");
  for (const Column& column : kColumns) {
    groups += fmt::format(" {:>9}", column.group);
    heads += fmt::format(" {:>9}", column.head);
  }
  fmt::print("{}\n{}\n", groups, heads);
  for (const Json& row : rows) {
    fmt::print("{:20} {:24} {:>5}", row["world"].get<std::string>(), row["method"].get<std::string>(),
               row["blended"].get<bool>() ? "yes" : "no");
    for (const Column& column : kColumns)
      fmt::print(" {:9.{}f}", row[column.key].get<double>(), column.decimals);
    fmt::print("\n");
  }
  std::fflush(stdout);
}

}  // namespace

int evaluate(const EvaluateOptions& options) {
  std::vector<std::string> laws = options.methods;
  for (const std::string& law : laws) find_row(extrapolators(), law, "method", "--method");
  if (laws.empty()) {
    for (const ExtrapolatorRow& row : extrapolators()) laws.emplace_back(row.name);
  }
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (!std::filesystem::is_directory(options.out, error))
    fail("{}: is no folder, and could not be made one", options.out.string());
  check_writable(options.out / "summary.json", Contents::kReport);
  ProgressLine progress;
  std::optional<Truth> truth;
  if (options.truth)
    truth.emplace(*options.truth, [&](double fraction) { progress("reading the truth", fraction); });
  if (truth && truth->flagged() > 0)
    log::warning(
        "{}: {} of its {} force samples are flagged, as its server found no settled answer; ticks beside "
        "them "
        "are not scored",
        options.truth->string(), truth->flagged(), truth->samples());
  Json rows = Json::array();
  for (const std::filesystem::path& capture : options.captures) {
    const Evaluation e = run(capture, laws, options, truth ? &*truth : nullptr, progress);
    std::vector<LawCost> costs;
    for (const std::string& law : laws)
      costs.push_back(request_of(law).surface ? cost_on(law, capture, e.run) : cost_of(law));
    const std::size_t begin = rows.size();
    add_rows(rows, options.world.empty() ? capture.stem().string() : options.world, e,
             truth ? &*truth : nullptr, costs);
    print_reference(rows, begin);
  }
  print(rows);
  write_json(options.out / "summary.json", rows);
  write_csv(options.out / "summary.csv", csv_of(rows));
  return 0;
}

Command evaluate_command() {
  const auto options = std::make_shared<EvaluateOptions>();
  return {
      .name = "evaluate",
      .summary = "Score every law on captures, against the true force",
      .footer = list_of_laws() +
                "Example: haptic_client evaluate liver.pcap --truth truth.pcap --out out/evaluation",
      .options =
          {{"CAPTURE", "Captures, best of sim_server record", &options->captures, {.required = true}},
           {"--truth",
            "Capture of the same motion at 200 samples a second or more: `sim_server record ... --rate 2000 "
            "--plain` (default: the force between the samples)",
            &options->truth},
           {"--out", "Folder for summary.json and summary.csv", &options->out, {.required = true}},
           {"--method", "Laws (default: all)", &options->methods, {.one_at_a_time = true}},
           {"--world", "Name for the first column (default: the capture's)", &options->world},
           {"--blend-ms", "Time constant of the blended rows (default 10 ms)", &options->blend_ms},
           {"--keep",
            "Laws get one force sample of so many: 4 makes 20 Hz of 80 Hz, and the reference the line "
            "between "
            "those that are left, as in the paper (default 1)",
            &options->keep,
            {.within = Bounds{1, 1000}}},
           {"--compliance",
            "Laws see a surface model so many times as compliant as it was sent (default 1)",
            &options->compliance,
            {.within = Bounds{0.01, 100}}}},
      .run = [options] {
        require_within(options->blend_ms, 0.1, 100, "--blend-ms", "ms");
        return evaluate(*options);
      }};
}

}  // namespace palpate::client
