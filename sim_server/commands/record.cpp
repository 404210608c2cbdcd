#include "sim_server/commands/record.h"

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/clock.h"
#include "common/config.h"
#include "common/error.h"
#include "common/log.h"
#include "common/overwrite.h"
#include "common/progress.h"
#include "common/report.h"
#include "sim_server/commands/explain.h"
#include "sim_server/commands/resection_log.h"
#include "sim_server/explicit/mass_scaling.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene/scene_print.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/virtual_session.h"
#include "sim_server/study/studied_errors.h"

namespace palpate::sim {
namespace {

constexpr double kUsualTicks = 500;           // Hz
constexpr std::uint64_t kSearchAround = 256;  // ticks between two looks at the progress line
constexpr double kLongest = 1e5;              // s

/// Reads the motions in the order of the tools; a tool that is captured needs one.
std::vector<Trajectory> read_motions(const RecordOptions& options, const Scene& scene) {
  if (options.trajectories.size() > scene.tools.size())
    fail("--trajectory: {} motions, but {} has {} [[tool]]{}", options.trajectories.size(),
         options.scene.string(), scene.tools.size(), scene.tools.size() == 1 ? "" : "s");
  if (options.tool > options.trajectories.size())
    fail("--tool {}: has no motion; give --trajectory once for each tool of the scene, in their order",
         options.tool);
  std::vector<Trajectory> motions;
  for (const auto& file : options.trajectories) {
    motions.emplace_back(motion_settings(file));
    motions.back().log_source();
  }
  return motions;
}

/// The CSV that a client file names.
std::optional<std::filesystem::path> file_of_motion(const std::filesystem::path& client) {
  if (client.extension() != ".toml") return {};
  const auto section = Config::read(client).table("trajectory");
  if (!section || !section->has("file")) return {};
  return section->file("file");
}

void require_distinct_files(const RecordOptions& options, const Scene& scene) {
  for (const auto& trajectory : options.trajectories)
    require_distinct({{"SCENE", options.scene},
                      {scene.mesh_where, scene.mesh_file},
                      {"--trajectory", trajectory},
                      {"the motion of --trajectory", file_of_motion(trajectory)},
                      {"--out", options.out},
                      {"--report", options.report},
                      {"--resection", options.resection},
                      {"--removals", options.removals},
                      {"--remove", options.remove}});
}

/// That all files can be written, and mean something for this scene: said before anything is set up.
void check_record_files(const RecordOptions& options, const Scene& scene) {
  require_distinct_files(options, scene);
  if (options.report) check_writable(*options.report, Contents::kReport);
  require_resection("--resection", options.resection, scene);
  require_resection("--removals", options.removals, scene);
  if (!scene.cutting) require_resection("--remove", options.remove, scene);
  require_no_blade("--removals", options.removals, scene);
  require_no_blade("--remove", options.remove, scene);
}

/// Tool states a second, Hz.
double tick_rate_of(const RecordOptions& options) {
  const double ticks_hz = options.ticks_hz.value_or(std::max(kUsualTicks, options.rate_hz));
  if (ticks_hz < options.rate_hz)
    fail("--ticks: {} Hz is less than --rate {} Hz; every step answers a tool state", ticks_hz,
         options.rate_hz);
  return ticks_hz;
}

void say_what_is_lost(const Trajectory& motion, const RecordOptions& options, double ticks_hz) {
  if (motion.rate_hz() <= ticks_hz * 1.001) return;
  log::info("{}: has {:.0f} rows a second, the capture keeps {:g}; `--ticks {:.0f}` keeps all",
            options.trajectories[options.tool - 1].string(), motion.rate_hz(), ticks_hz,
            std::ceil(motion.rate_hz()));
}

std::uint64_t ticks_of(const Trajectory& motion, const RecordOptions& options, double ticks_hz) {
  if (!options.seconds && motion.duration() > kLongest)
    fail("{}: lasts {:g} s; `--seconds` says how much of it to record, up to {:g}",
         options.trajectories[options.tool - 1].string(), motion.duration(), kLongest);
  return static_cast<std::uint64_t>(options.seconds.value_or(motion.duration()) * ticks_hz + 1e-6) + 1;
}

/// Steps begin when it is their time, and take what they take.
class RealTime final : public StepClock {
 public:
  void begin(Time t) override {
    if (!start_) start_ = now() - t;
    sleep_until(*start_ + t);
    began_ = now();
  }
  Time took() override { return now() - began_; }

 private:
  std::optional<Time> start_;
  Time began_{};
};

void run_session(VirtualSession& session, std::uint64_t ticks, protocol::CaptureWriter& capture,
                 const RecordOptions& options, ProgressLine& progress) {
  for (std::uint64_t k = 0; k < ticks; ++k) {
    session.tick(k);
    if (k % kSearchAround != 0) continue;
    progress("recording", static_cast<double>(k) / static_cast<double>(ticks));
  }
  session.leave();
  if (!capture.flush()) fail_at_run_time("{}: could not be written; is the disk full?", options.out.string());
  progress("recording", 1);
}

Json times_ms(const Histogram& ns) {
  return {{"p50", 1e-6 * ns.quantile(0.5)},
          {"p99", 1e-6 * ns.quantile(0.99)},
          {"max", 1e-6 * static_cast<double>(ns.max())}};
}

Json make_report(const RecordOptions& options, const VirtualSession& session, double ticks_hz,
                 const protocol::CaptureWriter& capture, const Simulation& simulation, double virtual_s) {
  const VirtualSessionStats& stats = session.stats();
  Json report = {{"scene", options.scene.string()},
                 {"trajectory", options.trajectories[options.tool - 1].string()},
                 {"tool", options.tool},
                 {"rate_hz", options.rate_hz},
                 {"ticks_hz", ticks_hz},
                 {"delay_ms", options.delay_ms},
                 {"virtual_seconds", virtual_s},
                 {"packets", capture.packets()},
                 {"bytes", capture.bytes()},
                 {"tool_states", stats.tool_states},
                 {"force_samples", stats.force_samples},
                 {"contact_steps", stats.in_contact},
                 {"contact_step_ms", times_ms(stats.contact_step_ns)},
                 {"late", stats.late},
                 {"flagged", stats.flagged},
                 {"flagged_by", simulation.flagged().to_json()},
                 {"added_mass_percent", 100 * simulation.traits().added_mass},
                 {"strain", simulation.strain() != nullptr ? simulation.strain()->to_json() : Json()},
                 {"max_newton", stats.max_newton},
                 {"missed_by_m", nullptr},
                 {"resection", resection_report(simulation)},
                 {"state_hash", fmt::format("{:016x}", simulation.state_hash())}};
  if (const auto missed = stats.missed.missed_by(options.tool - 1)) report["missed_by_m"] = *missed;
  add_to(report, "snap", stats.snaps.snaps());
  add_to(report, "unexplained_jump", stats.jumps.jumps());
  return report;
}

/// Figures of a recording whose `virtual_s` of virtual time took `took` (both s).
void print_recording(const RecordOptions& options, const VirtualSessionStats& stats,
                     const protocol::CaptureWriter& capture, const Simulation& simulation, double virtual_s,
                     double took) {
  fmt::print(
      "sim_server: {:.1f} s of virtual time in {:.2f} s; {} packets ({} tool states, {} force samples), {} "
      "bytes; {} steps in contact ({:.2f} ms median, {:.2f} ms p99 of processor time), {} flagged{}, largest "
      "force {:.2f} N\n",
      virtual_s, took, capture.packets(), stats.tool_states, stats.force_samples, capture.bytes(),
      stats.in_contact, 1e-6 * stats.contact_step_ns.quantile(0.5),
      1e-6 * stats.contact_step_ns.quantile(0.99), stats.flagged,
      stats.flagged > 0 ? " (" + simulation.flagged().to_text() + ")" : "", stats.max_newton);
  for (std::size_t i = 0; i < options.trajectories.size(); ++i) {
    if (const auto missed = stats.missed.missed_by(i))
      fmt::print("            {}; are its places metres in the scene's frame ([trajectory] scale, offset)?\n",
                 never_touched_text(i, *missed));
  }
  if (const auto snaps = stats.snaps.snaps()) fmt::print("            {}\n", snaps_text(*snaps));
  if (const auto jumps = stats.jumps.jumps()) fmt::print("            {}\n", unexplained_text(*jumps));
  if (const double added = simulation.traits().added_mass; added > 0)
    fmt::print("            {}\n", added_mass_text(added));
  if (simulation.strain() != nullptr && !simulation.strain()->to_text().empty())
    fmt::print("            {}\n", simulation.strain()->to_text());
  if (options.real_time)
    fmt::print("            {} of the deadlines of {:g} Hz passed over, as steps took too long\n", stats.late,
               options.rate_hz);
  if (const std::string cut = resection_text(simulation); !cut.empty()) fmt::print("            {}\n", cut);
}

}  // namespace

int record(const RecordOptions& options) {
  Scene scene = read_scene(options.scene);
  const double studied_hz = scene.rate_hz;
  scene.rate_hz = options.rate_hz;
  const double ticks_hz = tick_rate_of(options);
  const std::vector<Trajectory> motions = read_motions(options, scene);
  const Trajectory& motion = motions[options.tool - 1];
  const std::uint64_t ticks = ticks_of(motion, options, ticks_hz);
  check_record_files(options, scene);
  const ListedRemovals listed = options.remove ? read_removals(*options.remove) : ListedRemovals();
  AtomicFile out(options.out, Contents::kCapture);
  protocol::CaptureWriter capture(out.path());
  say_what_is_lost(motion, options, ticks_hz);
  ProgressLine progress;
  const auto cache = open_cache(options.cache);
  const auto condensed = open_condensed(options.cache, scene);
  Simulation simulation(scene, std::ref(progress), cache ? &*cache : nullptr,
                        condensed ? &*condensed : nullptr);
  if (options.remove) require_removable(listed, *options.remove, simulation);
  CutOptions cut{.keeps_log = options.resection.has_value(), .waits_for_background = !options.real_time};
  if (options.remove) cut.planned = listed.removals;
  simulation.set_cut_options(std::move(cut));
  auto studied = cache ? find_studied(*cache, scene) : std::nullopt;
  if (studied && studied_hz != options.rate_hz) studied->errors.time_step = {};  // of other steps
  const ErrorOfForce errors(scene, simulation, studied);
  RealTime clock;
  const VirtualLink link{.rate_hz = options.rate_hz,
                         .ticks_hz = ticks_hz,
                         .delay = from_seconds(options.delay_ms / 1e3),
                         .parts = options.parts,
                         .tool = options.tool - 1,
                         .scene = print_of(scene, simulation.mesh(),
                                           model_of(scene.deformation).body_to_text(scene.deformation)),
                         .clock = options.real_time ? &clock : nullptr};
  VirtualSession session(simulation, motions, link, capture, &errors);
  const Time start = now();
  run_session(session, ticks, capture, options, progress);
  set_aside({{"--out", options.out}, {"--resection", options.resection}, {"--removals", options.removals}},
            options.force);
  out.commit();
  const double took = to_seconds(now() - start), virtual_s = to_seconds(session.time_of(ticks - 1));
  print_recording(options, session.stats(), capture, simulation, virtual_s, took);
  if (options.resection) write_resection(*options.resection, simulation);
  if (options.removals) write_removals(*options.removals, simulation);
  if (options.report)
    write_json(*options.report, make_report(options, session, ticks_hz, capture, simulation, virtual_s));
  return 0;
}

Command record_command() {
  const auto options = std::make_shared<RecordOptions>();
  return {.name = "record",
          .summary = "Run a scene along a motion in virtual time, into a capture",
          .footer =
              list_of_models() +
              "Examples:\n"
              "  sim_server record configs/scenes/liver.toml --trajectory configs/clients/liver.toml --rate "
              "33.3 --delay-ms 35 --out liver.pcap\n"
              "  sim_server record configs/scenes/liver.toml --trajectory configs/clients/liver.toml --rate "
              "2000 --out truth.pcap",
          .options = joined(
              {{{"SCENE", "Scene file (TOML)", &options->scene, {.required = true}},
                {"--trajectory",
                 "Motion of a tool: a CSV (t_s, x_m, y_m, z_m), or a client file with a [trajectory]; once "
                 "for each "
                 "tool of the scene, in their order, those without one stay lifted",
                 &options->trajectories,
                 {.required = true, .one_at_a_time = true}},
                {"--tool",
                 "The tool whose session stands first in the capture, and in the figures, from 1",
                 &options->tool,
                 {.shows_default = true, .within = Bounds{1, 8}}},
                {"--rate",
                 "Steps a second, 1 to 20000 Hz; 2000 is the truth",
                 &options->rate_hz,
                 {.required = true}},
                {"--out", "Capture to write (pcap)", &options->out, {.required = true}},
                force_option(options->force),
                {"--delay-ms",
                 "From reading the tool to having its force in the client, ms, 0 to 10000",
                 &options->delay_ms,
                 {.shows_default = true}},
                {"--ticks", "Tool states a second, at least --rate (default: 500, or --rate if that is more)",
                 &options->ticks_hz},
                {"--seconds", "Virtual time (default: the motion once)", &options->seconds},
                {"!--plain", "Forces only: no tangents and surfaces, which some laws use (smaller)",
                 &options->parts},
                {"--real-time",
                 "Step at the pace of the clock: a sample is as late as this machine makes it, as with `run` "
                 "(not "
                 "the same bytes twice)",
                 &options->real_time},
                {"--report", "Write figures of the recording to this JSON file", &options->report},
                resection_option(options->resection),
                {"--removals", "Of a scene with [cutting]: write when each tetrahedron went to this CSV",
                 &options->removals},
                {"--remove",
                 "Remove what this CSV lists (t_s, tetrahedron), as --removals writes it, instead of by "
                 "heat: the "
                 "same cut at another --rate",
                 &options->remove}},
               cache_options(options->cache)}),
          .run = [options] {
            require_within(options->rate_hz, 1, 20000, "--rate", "Hz");
            require_within(options->delay_ms, 0, 10000, "--delay-ms", "ms");
            if (options->ticks_hz) require_within(*options->ticks_hz, 1, 20000, "--ticks", "Hz");
            if (options->seconds) require_within(*options->seconds, 1e-3, 1e5, "--seconds", "s");
            return record(*options);
          }};
}

}  // namespace palpate::sim
