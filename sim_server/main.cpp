#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "common/fast_blas.h"
#include "common/program.h"
#include "sim_server/commands/condense.h"
#include "sim_server/commands/explain.h"
#include "sim_server/commands/gallery.h"
#include "sim_server/commands/keygen.h"
#include "sim_server/commands/mesh_info.h"
#include "sim_server/commands/record.h"
#include "sim_server/commands/replay.h"
#include "sim_server/commands/run.h"
#include "sim_server/commands/solve.h"
#include "sim_server/commands/study.h"
#include "sim_server/commands/view.h"
#include "sim_server/models/deformation_models.h"

namespace {

using namespace palpate;

/// "  name   what it is" for each model.
std::string models() {
  std::string text = "Models ([deformation] model):\n";
  for (const auto& row : sim::deformation_models())
    text += fmt::format("  {:<24}{}\n", row.name, row.summary);
  return text;
}

void add_cache_options(CLI::App* command, sim::CacheOptions& options) {
  command->add_option("--cache", options.folder,
                      "Folder that keeps what set-ups computed (default: $XDG_CACHE_HOME/palpate, or "
                      "~/.cache/palpate)");
}

void add_cache_or_none(CLI::App* command, sim::CacheOptions& options) {
  add_cache_options(command, options);
  command->add_flag("--no-cache", options.none, "Compute everything anew, and keep nothing");
}

void add_condensed(CLI::App* command, sim::CacheOptions& options) {
  command->add_option("--condensed", options.condensed,
                      "Folder that `sim_server condense` made of this scene: set up from it");
}

void add_listen_options(CLI::App* command, sim::ListenOptions& options) {
  command
      ->add_option("--listen", options.address,
                   "ADDR:PORT to listen on (UDP); 0.0.0.0:45130 for other machines")
      ->capture_default_str();
  command->add_option("--key", options.key,
                      "File of keys; clients need one of them, see `sim_server keygen`");
  command->add_flag("--insecure", options.insecure, "Serve other machines without a key");
}

void add_viewer_option(CLI::App* command, std::string& address) {
  command
      ->add_option("--viewer", address,
                   "[ADDR:]PORT to serve the live page on (HTTP), or off; without ADDR on this machine alone")
      ->capture_default_str();
}

void add_resection_option(CLI::App* command, std::optional<std::filesystem::path>& file) {
  command->add_option("--resection", file,
                      "Of a scene with [cutting]: write what was removed, step by step, to this CSV");
}

CLI::App* add_run(CLI::App& app, sim::ServerOptions& options) {
  auto* command = app.add_subcommand("run", "Serve a scene until Ctrl-C");
  command->add_option("SCENE", options.scene, "Scene file (TOML)")->required();
  add_listen_options(command, options.listen);
  command->add_option("--seconds", options.seconds, "Stop after so many seconds");
  command->add_option("--report", options.report, "Write figures of the run to this JSON file");
  command->add_option("--record", options.record, "Write every datagram to this capture (pcap)");
  command
      ->add_option("--record-mb", options.record_mb,
                   "Go on in a new file at this size (F-2.pcap, ...); ten are kept")
      ->needs("--record")
      ->check(CLI::Range(0.01, 1e6));
  add_resection_option(command, options.resection);
  add_viewer_option(command, options.viewer);
  command->get_option("--insecure")->description("Serve other machines without a key, or the page in clear");
  add_cache_or_none(command, options.cache);
  add_condensed(command, options.cache);
  command->footer(
      models() +
      "Examples: sim_server run configs/scenes/liver.toml --report server.json\n"
      "          sim_server run configs/scenes/liver.toml --viewer 8080\n"
      "          sim_server run configs/scenes/liver.toml --listen 0.0.0.0:45130 --key palpate.key");
  return command;
}

CLI::App* add_record(CLI::App& app, sim::RecordOptions& options) {
  auto* command = app.add_subcommand("record", "Run a scene along a motion in virtual time, into a capture");
  command->add_option("SCENE", options.scene, "Scene file (TOML)")->required();
  command
      ->add_option(
          "--trajectory", options.trajectories,
          "Motion of a tool: a CSV (t_s, x_m, y_m, z_m), or a client file with a [trajectory]; once for "
          "each tool of the scene, in their order, those without one stay lifted")
      ->required()
      ->allow_extra_args(false);
  command->add_option("--tool", options.tool, "Which tool's session the capture holds, from 1")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  command->add_option("--rate", options.rate_hz, "Steps a second, 1 to 20000 Hz; 2000 is the truth")
      ->required();
  command->add_option("--out", options.out, "Capture to write (pcap)")->required();
  command
      ->add_option("--delay-ms", options.delay_ms,
                   "From reading the tool to having its force in the client, ms, 0 to 10000")
      ->capture_default_str();
  command->add_option("--ticks", options.ticks_hz,
                      "Tool states a second, at least --rate (default: 500, or --rate if that is more)");
  command->add_option("--seconds", options.seconds, "Virtual time (default: the motion once)");
  command->add_flag("!--plain", options.parts,
                    "Forces only: no tangents and surfaces, which some laws use (smaller)");
  command->add_flag(
      "--real-time", options.real_time,
      "Step at the pace of the clock: a sample is as late as this machine makes it, as with `run` "
      "(not the same bytes twice)");
  command->add_option("--report", options.report, "Write figures of the recording to this JSON file");
  add_resection_option(command, options.resection);
  command->add_option("--removals", options.removals,
                      "Of a scene with [cutting]: write when each tetrahedron went to this CSV");
  command->add_option("--remove", options.remove,
                      "Remove what this CSV lists (t_s, tetrahedron), as --removals writes it, instead of by "
                      "heat: the same cut at another --rate");
  add_cache_or_none(command, options.cache);
  add_condensed(command, options.cache);
  command->footer(
      models() +
      "Examples:\n"
      "  sim_server record configs/scenes/liver.toml --trajectory configs/clients/liver.toml --rate 33.3 "
      "--delay-ms 35 --out liver.pcap\n"
      "  sim_server record configs/scenes/liver.toml --trajectory configs/clients/liver.toml --rate 2000 "
      "--out "
      "truth.pcap");
  return command;
}

CLI::App* add_solve(CLI::App& app, sim::SolveOptions& options) {
  auto* command = app.add_subcommand("solve", "Solve a scene without a tool: loads, supports, one material");
  command
      ->add_option("SCENE", options.scene, "Scene file (TOML) with [mesh], [material], [[fixed]], [[load]]")
      ->required();
  command->add_option("--out", options.out, "Deformed mesh to write, for ParaView (.vtu)")->required();
  command->add_option("--probe", options.probes,
                      "Place in the body at rest, m: prints its displacement; repeatable");
  command->add_option(
      "--seconds", options.seconds,
      "Move for so long from rest, all loads there at once (default: the static equilibrium)");
  command->add_option("--step", options.step, "Step of the motion, s")
      ->capture_default_str()
      ->needs("--seconds");
  command->add_option("--series", options.series,
                      "Also write the motion for ParaView: a .pvd and its frames");
  command->add_option("--frames", options.frames, "How many frames about")
      ->capture_default_str()
      ->needs("--series");
  command->footer(
      "Examples:\n"
      "  sim_server solve configs/scenes/liver_weight.toml --out liver.vtu --probe 0.1,0.03,0.02\n"
      "  sim_server solve configs/scenes/liver_weight.toml --seconds 2 --out end.vtu --series motion.pvd");
  return command;
}

CLI::App* add_condense(CLI::App& app, sim::CondenseOptions& options) {
  auto* command = app.add_subcommand(
      "condense", "Set up a body too large for this machine, on many processes, for `run --condensed`");
  const std::string models =
      sim::models_that([](const sim::DeformationModelRow& row) { return row.condenses; });
  command->add_option("SCENE", options.scene, "Scene file (TOML) of one of the models " + models)->required();
  command
      ->add_option("--out", options.out,
                   "Folder to keep the result in; what it has already is not made again")
      ->required();
  command->add_flag("--iterative", options.iterative,
                    "Solve by conjugate gradients where a factor finds no memory: many times as long");
  command->add_option("--report", options.report, "Write times and memory to this JSON file");
  command->footer(
      "Examples:\n"
      "  mpirun -n 4 sim_server condense configs/scenes/liver.toml --out out/liver\n"
      "  mpirun -n 4 sim_server condense configs/scenes/liver.toml --out out/liver --iterative\n"
      "  sim_server run configs/scenes/liver.toml --condensed out/liver");
  return command;
}

CLI::App* add_explain(CLI::App& app, sim::ExplainOptions& options) {
  auto* command =
      app.add_subcommand("explain", "What a scene builds, what it leaves out, and what that saves");
  command->add_option("SCENE", options.scene, "Scene file (TOML)")->required();
  command->add_option("--json", options.json, "Write the same to this JSON file");
  add_cache_or_none(command, options.cache);
  add_condensed(command, options.cache);
  command
      ->add_option(
          "--why", options.why,
          "Only this part, built or left out: which line of the scene says so, and what it costs or saves")
      ->type_name("PART");
  command
      ->add_option("--steps", options.steps, "How many steps to time, free of the organ and in contact each")
      ->capture_default_str();
  command->footer(models() +
                  "Examples:\n"
                  "  sim_server explain configs/scenes/liver.toml --json explain.json\n"
                  "  sim_server explain configs/scenes/liver.toml --why compliance");
  return command;
}

CLI::App* add_study(CLI::App& app, sim::StudyOptions& options, sim::CacheOptions& cache) {
  auto* command = app.add_subcommand(
      "study", "Error against run time: models, elements, meshes, steps and tolerances around a scene's own");
  command->add_option("SCENE", options.scene, "Scene file (TOML)")->required();
  command
      ->add_option("--out", options.out,
                   "Folder for rows.csv, timing.csv, along.csv, reference.csv, summary.json; an interrupted "
                   "study goes on")
      ->required();
  command->add_option("--mesh", options.meshes,
                      "Another mesh of the same organ, coarser or finer; repeatable");
  command->add_option(
      "--trajectory", options.trajectory,
      "Motion of the tool: a CSV (t_s, x_m, y_m, z_m) (default: pressed, slid to and fro, lifted, 2 s)");
  command->add_option("--budget-ms", options.budget_ms,
                      "End with the case that is felt best at so many ms a step, as TOML");
  command
      ->add_option("--latency-ms", options.latency_ms,
                   "Of the link, from the end of a step to its force in the client, ms")
      ->capture_default_str();
  command->add_flag("--quick", options.quick, "Fewer steps, no finer meshes, a coarser reference: a minute");
  add_cache_or_none(command, cache);
  command->footer(models() +
                  "Example: sim_server study configs/scenes/liver.toml --out out/liver --budget-ms 33");
  return command;
}

CLI::App* add_scenes(CLI::App& app) {
  auto* command = app.add_subcommand("scenes", "The scenes that come with Palpate, and what each shows");
  command->footer("Example: sim_server scenes");
  return command;
}

CLI::App* add_mesh_info(CLI::App& app, std::string& file) {
  auto* mesh = app.add_subcommand("mesh", "Look at meshes");
  mesh->require_subcommand(1);
  mesh->footer("Example: sim_server mesh info configs/meshes/liver.msh");
  auto* info = mesh->add_subcommand(
      "info", "What is wrong with a Gmsh file (MSH 2.2 or 4.1), and its size and quality");
  info->add_option("FILE", file, "Mesh file, metres")->required();
  info->footer(
      "Lists every fault: what is mended on loading, and what has to be changed first (then exit code 2).\n"
      "Example: sim_server mesh info configs/meshes/liver.msh");
  return info;
}

CLI::App* add_replay(CLI::App& app, sim::ReplayOptions& options) {
  auto* command =
      app.add_subcommand("replay", "Play the forces of a capture to a live client and its device");
  command->add_option("--serve", options.capture, "pcap or pcapng with a session of Palpate")->required();
  add_listen_options(command, options.listen);
  command->add_option("--seconds", options.seconds,
                      "Stop after so many seconds (default: when all was played)");
  command->footer(
      "The forces come in their own time, wherever the tool is now; they carry no tangents. The client's "
      "limits\n"
      "hold as ever, and its passivity takes energy out that a force without a wall may bring in.\n"
      "Example: sim_server replay --serve F.pcap");
  return command;
}

CLI::App* add_view(CLI::App& app, sim::ViewOptions& options) {
  auto* command = app.add_subcommand("view", "Open a capture in the live page, to play and search it");
  command->add_option("F.pcap", options.capture, "pcap or pcapng with a session of Palpate")->required();
  command->add_option("--scene", options.scene,
                      "Scene file of that session: steps it again, so that the organ moves, too");
  add_viewer_option(command, options.viewer);
  command->add_option("--seconds", options.seconds, "Stop after so many seconds (default: at Ctrl-C)");
  add_cache_or_none(command, options.cache);
  add_condensed(command, options.cache);
  for (const char* of_scene : {"--cache", "--no-cache", "--condensed"})
    command->get_option(of_scene)->needs("--scene");
  command->footer("Example: sim_server view F.pcap --scene configs/scenes/liver.toml");
  return command;
}

struct KeygenOptions {
  std::string file;
  bool add = false;
};

CLI::App* add_keygen(CLI::App& app, KeygenOptions& options) {
  auto* command = app.add_subcommand("keygen", "Make a key, so that only who has it can push the motors");
  command->add_option("FILE", options.file, "Key file to make, for both programs")->required();
  command->add_flag("--add", options.add, "Put a new key behind those in FILE, to change keys");
  command->footer(
      "Without a key, both programs talk on this machine only.\n"
      "Example: sim_server keygen palpate.key");
  return command;
}

/// `cache list` and `cache clear`.
std::pair<CLI::App*, CLI::App*> add_cache(CLI::App& app, sim::CacheOptions& options) {
  auto* cache = app.add_subcommand("cache", "What set-ups have computed, kept on disk");
  cache->require_subcommand(1);
  cache->footer("Examples: sim_server cache list\n          sim_server cache clear");
  auto* list = cache->add_subcommand("list", "What is kept, how large it is, and what it saves");
  auto* clear = cache->add_subcommand("clear", "Remove all of it; the next set-ups compute it again");
  for (auto* command : {list, clear}) {
    add_cache_options(command, options);
    command->footer("Example: sim_server cache " + command->get_name());
  }
  return {list, clear};
}

/// The options of a command that serves, for a time if one is given; throws `Error` unless that is sensible.
template <class Options>
const Options& with_sensible_time(const Options& options) {
  if (options.seconds) require_at_least(*options.seconds, 1e-3, "--seconds", "s");
  return options;
}

/// The options of another command; throws `Error` unless they are within their bounds.
const auto& checked(const sim::SolveOptions& options) {
  if (options.seconds) require_within(*options.seconds, 1e-6, 1e6, "--seconds", "s");
  require_within(options.step, 1e-6, 1e3, "--step", "s");
  require_within(options.frames, 1, 100000, "--frames", "files");
  return options;
}

const auto& checked(const sim::ExplainOptions& options) {
  require_within(options.steps, 1, 100000, "--steps", "steps");
  return options;
}

const auto& checked(const sim::StudyOptions& options) {
  if (options.budget_ms) require_within(*options.budget_ms, 1e-3, 1e6, "--budget-ms", "ms");
  require_within(options.latency_ms, 0, 1000, "--latency-ms", "ms");
  return options;
}

const auto& checked(const sim::RecordOptions& options) {
  require_within(options.rate_hz, 1, 20000, "--rate", "Hz");
  require_within(options.delay_ms, 0, 10000, "--delay-ms", "ms");
  if (options.ticks_hz) require_within(*options.ticks_hz, 1, 20000, "--ticks", "Hz");
  if (options.seconds) require_within(*options.seconds, 1e-3, 1e5, "--seconds", "s");
  return options;
}

int run(int argc, char** argv) {
  CLI::App app{"Deforms an organ and answers a haptic client with forces, over UDP."};
  app.require_subcommand(1);
  app.footer("Example: sim_server run configs/scenes/liver.toml");
  sim::ServerOptions serving;
  sim::RecordOptions recording;
  sim::ExplainOptions explaining;
  std::string mesh_file;
  add_run(app, serving);
  const auto* record = add_record(app, recording);
  const auto* explain = add_explain(app, explaining);
  sim::SolveOptions solving;
  const auto* solve = add_solve(app, solving);
  sim::StudyOptions studying;
  sim::CacheOptions cached;
  const auto* study = add_study(app, studying, cached);
  sim::CondenseOptions condensing;
  const auto* condense = add_condense(app, condensing);
  const auto* scenes = add_scenes(app);
  const auto* mesh_info = add_mesh_info(app, mesh_file);
  sim::ReplayOptions replaying;
  const auto* replay = add_replay(app, replaying);
  sim::ViewOptions viewing;
  const auto* view = add_view(app, viewing);
  KeygenOptions making;
  const auto* keygen = add_keygen(app, making);
  const auto [list, clear] = add_cache(app, cached);
  if (const auto ended = parse_arguments(app, argc, argv)) return *ended;
  if (*mesh_info) return sim::print_mesh_info(mesh_file);
  if (*scenes) return sim::list_scenes();
  if (*replay) return sim::serve_replay(with_sensible_time(replaying));
  if (*view) return sim::view_capture(with_sensible_time(viewing));
  if (*keygen) return sim::make_key(making.file, making.add);
  if (*list) return sim::list_cache(cached);
  if (*clear) return sim::clear_cache(cached);
  if (*explain) return sim::run_explain(checked(explaining));
  if (*solve) return sim::solve(checked(solving));
  if (*condense) return sim::condense(condensing);
  if (*study) return sim::study(checked(studying), cached);
  if (*record) return sim::record(checked(recording));
  return sim::run_server(with_sensible_time(serving));
}

}  // namespace

int main(int argc, char** argv) {
  palpate::begin_with_fast_blas(argv);
  return palpate::run_program("sim_server", argc, argv, &run);
}
