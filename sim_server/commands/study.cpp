#include "sim_server/commands/study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/core.h>
#include <fstream>
#include <memory>

#include "common/clock.h"
#include "common/error.h"
#include "common/hash.h"
#include "common/log.h"
#include "common/memory_budget.h"
#include "common/progress.h"
#include "common/report.h"
#include "sim_server/commands/explain.h"
#include "sim_server/models/implicit.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/study/studied_errors.h"
#include "sim_server/study/study_errors.h"
#include "sim_server/study/study_table.h"

namespace palpate::sim {
namespace {

constexpr double kMargin = 1.5,
                 kNear = 1;  // of the tool's radius, around its path: what it may touch, and does

void add_file(Fnv1a& hash, const std::filesystem::path& file) {
  std::ifstream bytes(file, std::ios::binary);
  std::array<char, 1 << 16> block;
  while (bytes.read(block.data(), block.size()), bytes.gcount() > 0)
    hash.add(block.data(), static_cast<std::size_t>(bytes.gcount()));
}

/// Returns a fingerprint of all that traces depend on: the scene, the meshes, the motion and this program.
std::string fingerprint(const StudyOptions& options, const StudyPlan& plan) {
  Fnv1a hash;
  add_file(hash, options.scene);
  add_file(hash, plan.cases.front().scene.mesh_file);
  for (const auto& mesh : options.meshes) add_file(hash, mesh);
  if (options.trajectory) {
    add_file(hash, *options.trajectory);  // a client file says how to read the motion
    add_file(hash, motion_settings(*options.trajectory).file);
  }
  add_file(hash, "/proc/self/exe");
  return fmt::format("{:016x}", hash.value());
}

[[noreturn]] void fail_untouched(const StudyOptions& options) {
  fail(
      "{}: the tool never touches the organ on this path, so that there is no force to compare; its "
      "places are in m, in the scene's frame",
      options.trajectory.value_or(options.scene).string());
}

/// Runs cases, or finds that they were run before.
class Runner {
 public:
  /// `empty`: bytes of this program before it read anything.
  Runner(const StudyOptions& options, const StudyPlan& plan, double empty)
      : folder_(options.out / "traces" / fingerprint(options, plan)), empty_(empty) {
    std::filesystem::create_directories(folder_);
    progress_("finding where to press", 0);
    const StudyCase& own = plan.cases.front();
    const std::filesystem::path file = options.trajectory.value_or(folder_ / (own.name() + "-motion.csv"));
    if (!options.trajectory && !std::filesystem::exists(file))
      run_separately(own.name(), [&] { write_motion(file, press_and_slide(own)); });
    motion_.emplace(motion_settings(file));
    if (options.trajectory) motion_->log_source();
    seconds_ = motion_->duration();
    if (seconds_ < 4 / own.scene.rate_hz)
      fail("{}: lasts {:g} s, which is less than four steps of the scene", file.string(), seconds_);
    const double radius = own.scene.tools.front().shape.radius;
    sites_ = compared_sites(own, around(*motion_, radius));
    if (sites_.empty())  // it may be thinner than edges are long
      sites_ = compared_sites(own, around(*motion_, radius + describe(mesh_of(own)).max_edge));
    if (sites_.empty()) fail_untouched(options);
  }

  Trace run(const StudyCase& one, double fraction) {
    progress_(fmt::format("{}: {}", one.axis, one.name()), fraction);
    // The check may be a case under the same name, but for what its tool reaches.
    const std::filesystem::path file =
        folder_ / ((one.axis == "check" ? "check-" : "") + one.name() + ".trace");
    if (const std::optional<Trace> before = read_trace(file)) return *before;
    const double bytes =
        run_separately(one.name(), [&] { write_trace(file, run_case(one, *motion_, seconds_, sites_)); });
    std::optional<Trace> trace = read_trace(file);
    if (!trace) fail_at_run_time("{}: its trace {} is not whole", one.name(), file.string());
    trace->peak_bytes = empty_ + bytes;
    write_trace(file, *trace);
    return *trace;
  }

  /// The case with a tool that reaches what the motion touches, and no more, where the mesh is fine: the rest
  /// would be much, and for nothing.
  StudyCase near_the_path(StudyCase one) const {
    ToolSettings& tool = one.scene.tools.front();
    tool.reach = around(*motion_, kMargin * tool.shape.radius);
    return one;
  }

  const Trajectory& motion() const { return *motion_; }
  void end() { progress_("studied", 1); }

 private:
  static void write_motion(const std::filesystem::path& file, const Trajectory& motion) {
    std::string text = "t_s,x_m,y_m,z_m\n";
    for (long i = 0; i <= std::lround(1e3 * motion.duration()); ++i) {
      const Vec3 p = motion.at(1e-3 * static_cast<double>(i));
      text += fmt::format("{},{},{},{}\n", 1e-3 * static_cast<double>(i), p[0], p[1], p[2]);
    }
    write_csv(file, text);
  }

  std::filesystem::path folder_;
  std::optional<Trajectory> motion_;
  double seconds_ = 0;
  std::vector<Vec3> sites_;
  double empty_;
  ProgressLine progress_{"the same command goes on from there"};
};

StudyRow row_of(const Scene& scene, const StudyCase& one, const Trace& trace, const StudyErrors& errors) {
  StudyRow row{.scene = scene.title.empty() ? scene.source : scene.title, .one = one, .errors = errors};
  row.tetrahedra = trace.tetrahedra;
  row.nodes = trace.nodes;
  row.flagged = trace.flagged;
  row.touched = trace.step_ms_p50 > 0;
  row.state_hash = trace.state_hash;
  row.step_ms_p50 = trace.step_ms_p50;
  row.step_ms_p99 = trace.step_ms_p99;
  row.setup_ms = trace.setup_ms;
  row.peak_bytes = trace.peak_bytes;
  return row;
}

/// The scene as it is, with the shortest steps that were run.
const StudyCase* with_shortest_steps(const StudyCase& own, std::span<const StudyRow> rows) {
  const StudyCase* shortest = nullptr;
  for (const StudyRow& row : rows) {
    StudyCase same = own;
    same.scene.rate_hz = row.one.scene.rate_hz;
    if (row.one.name() != same.name()) continue;
    if (shortest == nullptr || row.one.scene.rate_hz > shortest->scene.rate_hz) shortest = &row.one;
  }
  return shortest;
}

/// Order of the error of a scene's steps in their length.
int order_of(const Scene& scene) {
  const auto* const implicit = scene.deformation.find<ImplicitSettings>();
  return implicit != nullptr && implicit->second_order ? 2 : 1;
}

/// Keeps what the study says of the scene as it is, for the reports of sessions; a quick one where there is
/// none yet.
void keep_for_sessions(const CacheOptions& where, const StudyOptions& options, Runner& runner,
                       const Scene& scene, const StudyResult& result, const Trace& reference,
                       double seconds) {
  const auto own = std::ranges::find(result.rows, "scene", [](const StudyRow& row) { return row.one.axis; });
  const auto cache = open_cache(where);
  if (!cache || own == result.rows.end() || (options.quick && find_studied(*cache, scene))) return;
  const StudyCase* shortest = with_shortest_steps(own->one, result.rows);
  const Trace by_shortest = runner.run(*shortest, 1), by_own = runner.run(own->one, 1);
  if (shortest->scene.rate_hz <= own->one.scene.rate_hz || by_shortest.flagged > 0 || by_own.flagged > 0) {
    log::info(
        "not kept for the reports of sessions: the scene has not settled in every step, or ran with no "
        "shorter ones");
    return;
  }
  const SplitError split = split_error(by_own, by_shortest, order_of(scene), reference, runner.motion());
  if (result.own.force > 0.5 * split.mesh) {
    log::info(
        "not kept for the reports of sessions: the reference itself may be {:.2g} % off, the mesh {:.2g} %",
        result.own.force, split.mesh);
    return;
  }
  const auto measured = [](double percent) {
    return DiscretisationError{ErrorSource::kMeasured, static_cast<float>(percent)};
  };
  std::optional<StudiedErrors> studied = pressed_in(by_own);
  if (!studied) return;
  studied->errors = {measured(split.mesh), measured(split.time_step)};
  keep_studied(*cache, scene, *studied, seconds);
}

}  // namespace

int study(const StudyOptions& options, const CacheOptions& cache) {
  const Time begin = now();
  const double empty = resident_memory();
  const Scene scene = read_scene(options.scene);
  StudyPlan plan = plan_study(scene, options);
  std::error_code failed;
  std::filesystem::create_directories(options.out, failed);
  check_writable(options.out / "summary.json", Contents::kReport);
  Runner runner(options, plan, empty);
  refine_references(plan, around(runner.motion(), kNear * scene.tools.front().shape.radius));
  const double latency = 1e-3 * options.latency_ms;
  const Trace reference = runner.run(runner.near_the_path(plan.reference), 0),
              check = runner.run(runner.near_the_path(plan.check), 0.1);
  if (std::ranges::all_of(reference.forces, [](const Vec3& f) { return f.isZero(0); }))
    fail_untouched(options);
  StudyResult result{.own = errors_of(check, reference, runner.motion(), latency), .rows = {}};
  result.reference = plan.reference.name();
  result.check = plan.check.name();
  result.truth = reference;
  if (std::ranges::none_of(scene.fixed, &FixedRegion::moves)) result.jumps = unexplained_jumps(reference);
  for (std::size_t k = 0; k < plan.cases.size(); ++k) {
    const StudyCase& one = plan.cases[k];
    const double fraction = 0.2 + 0.8 * static_cast<double>(k) / static_cast<double>(plan.cases.size());
    try {
      const Trace trace = runner.run(one, fraction);
      result.rows.push_back(row_of(scene, one, trace, errors_of(trace, reference, runner.motion(), latency)));
    } catch (const CaseFailed& error) {
      result.refused.emplace_back(one.name(), error.what());
    }
  }
  runner.end();
  if (result.rows.empty())
    fail_at_run_time("{}: no case could be run; of the first: {}", options.scene.string(),
                     result.refused.front().second);
  mark_front(result.rows);
  write_study(options, result);
  keep_for_sessions(cache, options, runner, scene, result, reference, to_seconds(now() - begin));
  fmt::print("{}", to_text(result));
  if (scene.tools.size() > 1)
    fmt::print("Only tool 1 of {} is moved and compared; the others are away.\n", scene.tools.size());
  if (options.budget_ms) fmt::print("{}", advice(result, *options.budget_ms, scene));
  return 0;
}

Command study_command() {
  struct Requested {
    StudyOptions study;
    CacheOptions cache;
  };
  const auto requested = std::make_shared<Requested>();
  StudyOptions& options = requested->study;
  return {
      .name = "study",
      .summary =
          "Error against run time: models, elements, meshes, steps and tolerances around a scene's own",
      .footer = list_of_models() +
                "Example: sim_server study configs/scenes/liver.toml --out out/liver --budget-ms 33",
      .options = joined(
          {{{"SCENE", "Scene file (TOML)", &options.scene, {.required = true}},
            {"--out",
             "Folder for rows.csv, timing.csv, along.csv, reference.csv, summary.json; an interrupted study "
             "goes on",
             &options.out,
             {.required = true}},
            {"--mesh", "Another mesh of the same organ, coarser or finer; repeatable", &options.meshes},
            {"--trajectory",
             "Motion of the tool: a CSV (t_s, x_m, y_m, z_m), or a client file with a [trajectory] (default: "
             "pressed, slid to and fro, lifted, 2 s)",
             &options.trajectory},
            {"--budget-ms",
             "Report the case with the smallest rendered error within so many ms a step, as TOML",
             &options.budget_ms},
            {"--latency-ms",
             "Of the link, from the end of a step to its force in the client, ms",
             &options.latency_ms,
             {.shows_default = true}},
            {"--quick", "Fewer steps, no finer meshes, a coarser reference: a minute", &options.quick}},
           cache_or_none(requested->cache)}),
      .run = [requested] {
        if (requested->study.budget_ms)
          require_within(*requested->study.budget_ms, 1e-3, 1e6, "--budget-ms", "ms");
        require_within(requested->study.latency_ms, 0, 1000, "--latency-ms", "ms");
        return study(requested->study, requested->cache);
      }};
}

}  // namespace palpate::sim
