#include "sim_server/commands/run.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <unistd.h>

#include "common/ages.h"
#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/log.h"
#include "common/overwrite.h"
#include "common/progress.h"
#include "common/realtime.h"
#include "common/report.h"
#include "common/text.h"
#include "protocol/key_file.h"
#include "protocol/link_report.h"
#include "protocol/recording_report.h"
#include "sim_server/commands/explain.h"
#include "sim_server/commands/gallery.h"
#include "sim_server/commands/live_view.h"
#include "sim_server/commands/page_news.h"
#include "sim_server/commands/pictures.h"
#include "sim_server/commands/resection_log.h"
#include "sim_server/commands/run_news.h"
#include "sim_server/explicit/mass_scaling.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene/scene_print.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/net_link.h"
#include "sim_server/simulation/setup_times.h"
#include "sim_server/study/studied_errors.h"

namespace palpate::sim {
namespace {

void warn_if_refused(const std::string& refused) {
  if (!refused.empty()) log::warning("{}", refused);
}

/// Clients let go of a force that is older than `kOutage`; a third of that is for the link, and steps that
/// are late.
void warn_if_slow(const Scene& scene) {
  const double least_hz = 1.5 / to_seconds(kOutage);
  if (scene.rate_hz > 0 && scene.rate_hz < least_hz)
    log::warning("{}: at {} steps per second the force fades between samples; {:g} or more keep it",
                 scene.source, scene.rate_hz, least_hz);
}

/// Everything known about the scene before the loop starts.
Json describe_scene(const Scene& scene, const Simulation& simulation, Time setup, const SetupTimes& parts) {
  const MeshInfo info = describe(simulation.mesh());
  Json memory = Json::object();
  for (const MemoryPart& part : simulation.memory()) memory[part.name] = part.bytes;
  return {{"scene", scene.source},
          {"title", scene.title},
          {"model", scene.deformation.model},
          {"rate_hz", scene.rate_hz},
          {"setup_ms", 1e3 * to_seconds(setup)},
          {"setup_parts_ms", parts.to_json()},
          {"mesh", {{"vertices", info.vertices}, {"edges", info.edges}, {"tetrahedra", info.tetrahedra}}},
          {"memory_bytes", memory}};
}

Json timeline_report(const Timeline<StepCell>& timeline) {
  Json cells = Json::array();
  for (std::size_t i = 0; i < timeline.size(); ++i) {
    const StepCell& cell = timeline[i];
    cells.push_back({{"t_s", static_cast<double>(i) * to_seconds(timeline.width())},
                     {"steps", cell.steps},
                     {"step_ms_mean", cell.steps > 0 ? 1e-6 * cell.step_ns_sum / cell.steps : 0},
                     {"step_ms_max", 1e-6 * cell.step_ns_max},
                     {"late", cell.late}});
  }
  return {{"cell_s", to_seconds(timeline.width())}, {"cells", cells}};
}

Json json_of(std::optional<double> value) {
  return value ? Json(*value) : Json(nullptr);
}

Json percent_of(const DiscretisationError& error) {
  return error.known() ? Json(error.percent) : Json(nullptr);
}

/// Returns what mesh and time step cost the force of a tool that pressed on tissue.
Json rendered_report(const ErrorOfForce& errors, std::size_t tool) {
  const auto elements = errors.elements_per_radius(tool);
  if (!elements) return nullptr;
  const DiscretisationErrors all = errors.of_all_steps(tool);
  return {{"elements_per_radius", *elements},
          {"mesh_percent", percent_of(all.mesh)},
          {"motion_percent", percent_of(all.time_step)},
          {"how", {{"mesh", name_of(all.mesh.source)}, {"motion", name_of(all.time_step.source)}}}};
}

Json tools_report(const SimLoopStats& stats, const NetLink& link, const Scene& scene,
                  const ErrorOfForce& errors) {
  Json tools = Json::array();
  for (std::size_t i = 0; i < scene.tools.size(); ++i) {
    Json tool = {{"radius_m", scene.tools[i].shape.radius},
                 {"max_newton", stats.tools[i].max_newton},
                 {"contact_steps", stats.tools[i].contact_steps},
                 {"beyond_steps", stats.tools[i].beyond_steps},
                 {"missed_by_m", json_of(stats.missed.missed_by(i))},
                 {"rendered", rendered_report(errors, i)},
                 {"sessions", link.tools[i].so_far.load()}};
    add_to(tool, "unexplained_jump", stats.tools[i].jumps.jumps());
    tools.push_back(std::move(tool));
  }
  return tools;
}

void add_run(Json& report, const SimLoop& loop, const NetLink& link, const Simulation& simulation,
             const Scene& scene, const ErrorOfForce& errors, Time ran) {
  const SimLoopStats& stats = loop.stats();
  report["seconds"] = to_seconds(ran);
  report["steps"] = stats.step_ns.count();
  report["step_ms"] = quantiles(stats.step_ns, 1e6);
  report["contact_step_ms"] = quantiles(stats.contact_step_ns, 1e6);
  report["contact_steps"] = stats.contact_step_ns.count();
  report["timeline"] = timeline_report(stats.timeline);
  report["late"] = stats.late;
  report["flagged"] = stats.flagged;
  report["flagged_by"] = simulation.flagged().to_json();
  report["added_mass_percent"] = 100 * simulation.traits().added_mass;
  report["strain"] = simulation.strain() != nullptr ? simulation.strain()->to_json() : Json();
  report["max_newton"] = stats.max_newton();
  report["tools"] = tools_report(stats, link, scene, errors);
  int sessions = 0;
  for (const auto& tool : link.tools) sessions += tool.so_far;
  report["sessions"] = sessions;
  report["link"] = protocol::link_report(link.stats());
  report["failed_steps"] = {{"out_of_memory", simulation.failures().out_of_memory},
                            {"other", simulation.failures().other}};
  report["resection"] = resection_report(simulation);
  report["state_hash"] = fmt::format("{:016x}", simulation.state_hash());
}

/// "the mesh an unknown part of the force", "the mesh 3.5 % of the force (estimated)".
std::string cost_text(const char* what, const Json& rendered, const char* percent, const char* how) {
  if (rendered[percent].is_null()) return fmt::format("{} an unknown part of the force", what);
  return fmt::format("{} {} % of the force ({})", what, two_figures(rendered[percent].get<double>()),
                     rendered["how"][how].get<std::string>());
}

/// Prints the errors of each tool that pressed on tissue.
void print_errors(const Json& report) {
  for (std::size_t i = 0; i < report["tools"].size(); ++i) {
    const Json& rendered = report["tools"][i]["rendered"];
    if (rendered.is_null()) continue;
    fmt::print("            tool {}, {:.1f} elements to its radius where it pressed: {}, {}\n", i + 1,
               rendered["elements_per_radius"].get<double>(),
               cost_text("the mesh costs", rendered, "mesh_percent", "mesh"),
               cost_text("the time step", rendered, "motion_percent", "motion"));
    const Json& how = rendered["how"]["mesh"];
    if (how != name_of(ErrorSource::kMeasured) && how != name_of(ErrorSource::kNone))
      fmt::print("            `sim_server study {} --out DIR` measures both for this scene\n",
                 report["scene"].get<std::string>());
  }
}

std::string strain_text(const Simulation& simulation) {
  return simulation.strain() != nullptr ? simulation.strain()->to_text() : "";
}

void print_summary(const Json& report, const Simulation& simulation) {
  const auto ms = [&](const char* key, const char* q) { return report[key][q].get<double>(); };
  fmt::print(
      "sim_server: {} steps, {} in contact; a step takes {:.3f} ms (p50), {:.3f} (p99), {:.3f} (max)\n",
      report["steps"].get<long>(), report["contact_steps"].get<long>(), ms("step_ms", "p50"),
      ms("step_ms", "p99"), ms("step_ms", "max"));
  fmt::print(
      "            in contact {:.3f} ms (p50), {:.3f} (p99); {} deadlines late; largest force {:.2f} N\n",
      ms("contact_step_ms", "p50"), ms("contact_step_ms", "p99"), report["late"].get<long>(),
      report["max_newton"].get<double>());
  if (const std::string rights = real_time_text(report); !rights.empty())
    fmt::print("            {}\n", rights);
  if (const std::string why = simulation.flagged().to_text(); !why.empty())
    fmt::print("            steps with a flagged force: {}\n", why);
  if (const double added = simulation.traits().added_mass; added > 0)
    fmt::print("            {}\n", added_mass_text(added));
  if (const std::string strain = strain_text(simulation); !strain.empty())
    fmt::print("            {}\n", strain);
  for (std::size_t i = 0; i < report["tools"].size(); ++i) {
    const Json& missed = report["tools"][i]["missed_by_m"];
    if (missed.is_null()) continue;
    fmt::print("            {}; is the client file made for this scene ([session] clients)?\n",
               never_touched_text(i, missed.get<double>()));
  }
  print_errors(report);
  for (std::size_t i = 0; i < report["tools"].size(); ++i) {
    if (const auto jumps = jumps_in(report["tools"][i], "unexplained_jump"))
      fmt::print("            tool {}: {}\n", i + 1, unexplained_text(*jumps));
  }
  std::fflush(stdout);
}

/// The scene that a page chose, if one did; the choice is taken back where its file is wrong.
std::optional<Scene> chosen_scene(ViewerFeed& feed, const std::vector<GalleryScene>& gallery) {
  const int chosen = feed.chosen;
  if (chosen < 0) return {};
  try {
    return read_scene(gallery[static_cast<std::size_t>(chosen)].file);
  } catch (const Error& error) {
    log::error("{} (a page chose it; this scene goes on)", error.what());
    feed.chosen = -1;
    return {};
  }
}

/// Waits for Ctrl-C, the end of `seconds` or another scene that a page chose, which is returned, telling who
/// comes and goes.
std::optional<Scene> watch(NetLink& link, const SimLoop& loop, const Scene& scene,
                           protocol::RecordingWatcher& recording, LiveView* view,
                           const std::vector<GalleryScene>& gallery, std::optional<double> seconds) {
  const Time start = now();
  RunEvents events(scene);
  while (!wait_for_interrupt(std::chrono::milliseconds(100))) {
    if (seconds && to_seconds(now() - start) >= *seconds) return {};
    if (view != nullptr) {
      if (auto chosen = chosen_scene(view->feed(), gallery)) return chosen;
    }
    recording.look();
    link.watcher.poll("");
    events.report(link, loop, view != nullptr && view->feed().paused);
  }
  return {};
}

void warn_if_out_of_reach(const Simulation& simulation, const Scene& scene) {
  for (std::size_t i = 0; i < scene.tools.size(); ++i) {
    if (simulation.touchable(i).empty())
      log::warning("{}: tool {} reaches no part of the surface and will feel nothing; is this in metres?",
                   scene.tools[i].reach_where, i + 1);
  }
}

/// Fewer elements than one to a radius cannot follow the tip.
void warn_if_coarse(const ErrorOfForce& errors, const Simulation& simulation, const Scene& scene) {
  for (std::size_t i = 0; i < scene.tools.size(); ++i) {
    const auto finest = errors.finest(i, simulation.touchable(i));
    if (!finest || *finest >= 1) continue;
    log::warning(
        "{}: where the mesh is finest, {:.2g} elements come to a radius of tool {}; below 1 the force is far "
        "off; "
        "`sim_server study {} --out DIR` says how far",
        scene.mesh_where, *finest, i + 1, scene.source);
  }
}

/// The page, with what it may choose: nothing while a capture is written, which holds one session.
std::unique_ptr<LiveView> open_view(const ViewRequest& request, const Scene& scene,
                                    const Simulation& simulation, const std::vector<GalleryScene>& gallery,
                                    Time start) {
  SceneFacts facts = facts_of(scene, simulation);
  facts.pausable = true;
  for (const GalleryScene& other : gallery) facts.gallery.push_back(other.name);
  return std::make_unique<LiveView>(request.address, request.token, std::move(facts), simulation, start);
}

/// That the files of a run can be written, and none over another: said before the set-up.
void check_run_files(const ServerOptions& options, const Scene& scene) {
  require_distinct({{"SCENE", scene.source},
                    {scene.mesh_where, scene.mesh_file},
                    {"--report", options.report},
                    {"--key", options.listen.key},
                    {"--resection", options.resection},
                    {"--record", options.record}});
  if (options.report) check_writable(*options.report, Contents::kReport);
  require_resection("--resection", options.resection, scene);
}

/// The thread that writes the capture; none without a recorder.
std::jthread start_recording(protocol::Recorder* recorder) {
  if (recorder == nullptr) return {};
  return std::jthread([recorder](const std::stop_token& stop) {
    take_role(ThreadRole::kRecording);
    recorder->run(stop);
  });
}

/// The thread that serves the page; none where there is no page.
std::jthread start_viewing(LiveView* view) {
  if (view == nullptr) return {};
  return std::jthread([view](const std::stop_token& stop) {
    take_role(ThreadRole::kPage);
    const std::stop_callback ends(stop, [view] { view->viewer().stop(); });
    view->viewer().run();
  });
}

/// Simulation, network, recording and page, each in a thread of its own, until `watching`, in this one, is
/// over or throws. Returns what it returned. Notes in `real_time` whether network and simulation have the
/// priority of their roles.
template <class Watching>
auto serve_until(SimLoop& loop, NetLink& link, protocol::Recorder* recorder, LiveView* view, bool& real_time,
                 const Watching& watching) {
  const std::jthread recording = start_recording(recorder);
  std::jthread net([&](const std::stop_token& stop) {
    const std::stop_callback ends(stop, [&] { link.stop(); });
    link.run();
  });
  const std::jthread viewing = start_viewing(view);
  std::jthread sim([&](const std::stop_token& stop) { loop.run(stop); });
  const std::string refused = give_roles(
      {{net.native_handle(), ThreadRole::kNetwork}, {sim.native_handle(), ThreadRole::kSimulation}});
  real_time = refused.empty();
  warn_if_refused(refused);
  warn_if_refused(lock_memory());  // after the threads, whose stacks a small limit would not hold
  return watching();               // then each is asked to stop, the simulation first
}

/// Reports the results of a run, on the terminal and in the files that were requested.
void report_results(const ServerOptions& options, const Simulation& simulation, const Json& report) {
  print_summary(report, simulation);
  if (const std::string cut = resection_text(simulation); !cut.empty()) fmt::print("            {}\n", cut);
  if (options.resection) write_resection(*options.resection, simulation);
  if (options.report) write_json(*options.report, report);
}

/// One scene, from its set-up to its report. What it listens on is put into `options` and `request`, so that
/// the next scene is found there; `before`, which stands in for it where its set-up fails, is let go when it
/// is ready. Returns what a page chose, of `gallery`.
std::optional<Scene> serve_scene(ServerOptions& options, std::optional<ViewRequest>& request,
                                 const std::vector<GalleryScene>& gallery, const Scene& scene,
                                 std::optional<Scene>& before) {
  check_run_files(options, scene);
  std::vector<double> radii;
  for (const ToolSettings& tool : scene.tools) radii.push_back(tool.shape.radius);
  protocol::ServerSessions sessions = sessions_for(options.listen, scene.rate_hz, radii);
  protocol::UdpSocket socket = open_socket(options.listen);
  options.listen.address = protocol::to_string(socket.local());
  const auto recorder = options.record
                            ? std::make_unique<protocol::Recorder>(
                                  *options.record, protocol::bytes_of_mb(options.record_mb), options.force)
                            : nullptr;
  const Time begin = now();
  SetupTimes progress{ProgressLine()};
  const auto cache = open_cache(options.cache);
  const auto condensed = open_condensed(options.cache, scene);
  Simulation simulation(scene, std::ref(progress), cache ? &*cache : nullptr,
                        condensed ? &*condensed : nullptr);
  simulation.set_cut_options({.keeps_log = options.resection.has_value(), .waits_for_background = false});
  warn_if_slow(scene);
  warn_if_out_of_reach(simulation, scene);
  auto studied = cache ? find_studied(*cache, scene) : std::nullopt;
  if (studied && scene.rate_hz == 0) studied->errors.time_step = {};  // steps are as clients ask for them
  ErrorOfForce errors(scene, simulation, studied);
  warn_if_coarse(errors, simulation, scene);
  sessions.set_scene(
      print_of(scene, simulation.mesh(), model_of(scene.deformation).body_to_text(scene.deformation)));
  Json report = describe_scene(scene, simulation, now() - begin, progress);
  SimMailboxes mailboxes;
  const Time start = now();
  const auto view = request ? open_view(*request, scene, simulation, gallery, start) : nullptr;
  if (view) request->address.endpoint = view->viewer().endpoint();
  SimLoop loop(simulation, scene.rate_hz, mailboxes, scene.tools, errors, view.get());
  const auto page = view ? std::make_unique<PageMailboxes>() : nullptr;
  NetLink link(socket, std::move(sessions), mailboxes, recorder.get(), page.get());
  if (view) {
    view->feed().hooks = page_hooks(view->feed(), scene.tools.size(), *page, mailboxes.bell, start);
    if (!view->facts().fields.empty()) view->feed().hooks.field = strain_energy_of(scene, simulation);
  }
  protocol::RecordingWatcher recording(recorder.get());
  bool real_time = false;
  auto chosen = serve_until(loop, link, recorder.get(), view.get(), real_time, [&] {
    if (view) log::info("the live page: {}", view->link());
    log::info("\"{}\" ready after {:.2f} s, listening on {} (UDP); Ctrl-C ends it", scene.title,
              report["setup_ms"].get<double>() / 1e3, options.listen.address);
    before.reset();
    return watch(link, loop, scene, recording, view.get(), gallery, options.seconds);
  });
  recording.look();  // what was written at the end
  add_run(report, loop, link, simulation, scene, errors, now() - start);
  report["real_time"] = real_time;
  if (recorder) report["recording"] = protocol::recording_report(*recorder);
  report_results(options, simulation, report);
  return chosen;
}

}  // namespace

int run_server(const ServerOptions& options) {
  ServerOptions now_served = options;
  std::optional<ViewRequest> request = view_request(options.viewer, options.listen);
  const std::vector<GalleryScene> gallery =
      request && !options.record ? find_gallery() : std::vector<GalleryScene>{};
  Scene scene = read_scene(options.scene);
  const Time start = now();
  for (std::optional<Scene> before;;) {
    if (options.seconds) now_served.seconds = std::max(0.001, *options.seconds - to_seconds(now() - start));
    try {
      auto chosen = serve_scene(now_served, request, gallery, scene, before);
      if (!chosen) return 0;
      before = std::exchange(scene, std::move(*chosen));
      log::info("a page chose {}", scene.source);
    } catch (const Error& error) {
      if (!before) throw;
      log::error("{} (a page chose it; {} comes back)", error.what(), before->source);
      scene = *std::exchange(before, std::nullopt);
    }
  }
}

Command run_command() {
  const auto options = std::make_shared<ServerOptions>();
  return {
      .name = "run",
      .summary = "Serve a scene until Ctrl-C",
      .footer = list_of_models() +
                "Examples: sim_server run configs/scenes/liver.toml --report server.json\n"
                "          sim_server run configs/scenes/liver.toml --viewer 8080\n"
                "          sim_server run configs/scenes/liver.toml --listen 0.0.0.0:45130 --key palpate.key",
      .options =
          joined({{{"SCENE", "Scene file (TOML)", &options->scene, {.required = true}}},
                  listen_options(options->listen, "Serve other machines without a key, or the page in clear"),
                  {{"--seconds", "Stop after so many seconds", &options->seconds},
                   {"--report", "Write figures of the run to this JSON file", &options->report},
                   {"--record", "Write every datagram to this capture (pcap)", &options->record},
                   {"--record-mb",
                    "Go on in a new file at this size (F-2.pcap, ...); ten are kept",
                    &options->record_mb,
                    {.within = Bounds{0.01, 1e6}, .needs = "--record"}},
                   force_option(options->force),
                   resection_option(options->resection),
                   viewer_option(options->viewer)},
                  cache_options(options->cache)}),
      .run = [options] {
        if (options->seconds) require_at_least(*options->seconds, 1e-3, "--seconds", "s");
        return run_server(*options);
      }};
}

}  // namespace palpate::sim
