#include "sim_server/commands/view.h"

#include <algorithm>
#include <fmt/core.h>
#include <limits>
#include <memory>
#include <span>
#include <thread>

#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/log.h"
#include "common/progress.h"
#include "common/realtime.h"
#include "protocol/scene_print.h"
#include "protocol/session.h"
#include "protocol/udp_socket.h"
#include "sim_server/commands/live_view.h"
#include "sim_server/commands/pictures.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene/scene_print.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/captured_forces.h"
#include "sim_server/serving/captured_rerun.h"
#include "sim_server/serving/captured_steps.h"
#include "sim_server/simulation/setup_times.h"
#include "sim_server/viewer/recorded_session.h"
#include "sim_server/viewer/viewer.h"

namespace palpate::sim {
namespace {

constexpr double kSimilar = 0.1;  // of the largest force: how far off a scene is that is not the captured one

/// Shows what a session has to show without a scene.
void show_captured(const CapturedAnswer& answer, Picture& picture) {
  SeenTool& seen = picture.tools[answer.sample.tool];
  const protocol::ForceSample& sample = answer.sample;
  seen.held = true;
  seen.pose = pose_of(answer.state);
  seen.contact = (sample.flags & protocol::ForceSample::kInContact) != 0;
  seen.flagged = (sample.flags & protocol::ForceSample::kFlagged) != 0;
  seen.f_W = sample.f_W;
  seen.sample = {sample.number, to_seconds(answer.t), static_cast<float>(sample.f_W.norm()), sample.flags};
  picture.step_ms = 1e-6 * static_cast<double>(sample.step_ns);
}

/// Returns the tools that sessions hold. Where several held one, it is that of the longest.
std::vector<Tool> tools_of(std::span<const CapturedForces> sessions) {
  std::vector<Tool> tools;
  for (auto session = sessions.rbegin(); session != sessions.rend(); ++session) {
    if (session->tool >= tools.size()) tools.resize(session->tool + 1U);
    tools[session->tool] = {.radius = session->tool_radius};
  }
  return tools;
}

/// Steps the answers taken, and shows where that led at `t`.
void step_again(CapturedRerun& rerun, const Simulation& simulation, Time t, Picture& picture) {
  const auto outcomes = rerun.step();
  picture.step = rerun.steps();
  picture.simulated = rerun.simulated();
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    show_tool(rerun.inputs()[i], &outcomes[i], to_seconds(t), picture.tools[i]);
  show_organ(simulation, picture);
}

/// All of the capture, of about so many answers, into `session`. `simulation`, which may be null, with its
/// `rerun`: is stepped again.
void make_session(const std::filesystem::path& capture, std::size_t answers, const Simulation* simulation,
                  CapturedRerun* rerun, RecordedSession& session) {
  constexpr std::size_t kBetweenReports = 100;  // answers: 3 s of a session at 30 Hz
  Time t{}, newest{};
  ProgressLine progress("nothing is shown");
  std::size_t taken = 0;
  // Nothing is known of how far each step goes.
  if (rerun == nullptr) session.picture().simulated = std::numeric_limits<double>::quiet_NaN();
  bool pending = false, all = true;
  const auto finish = [&] {
    if (!pending) return;
    if (rerun != nullptr) step_again(*rerun, *simulation, t, session.picture());
    all = session.add(t) && all;
    pending = false;
  };
  read_captured_steps(
      capture,
      [&](std::uint64_t sender, const protocol::ToolState& state) {
        if (rerun != nullptr) rerun->take(sender, state);
      },
      [&](const CapturedAnswer& answer) {
        if (taken++ % kBetweenReports == 0)
          progress("reading the capture",
                   std::min(1.0, static_cast<double>(taken) / static_cast<double>(answers)));
        if (answer.begins_step) finish();
        newest = std::max(newest, answer.t);
        t = newest;
        pending = true;
        show_captured(answer, session.picture());
        if (rerun != nullptr) {
          rerun->take(answer);
        } else if (answer.begins_step) {
          ++session.picture().step;
        }
      },
      [&](std::uint64_t departed) {
        if (rerun != nullptr) rerun->release(departed);
      });
  finish();
  if (!all)
    log::warning("{}: only the first {:.0f} MB of what a page would have got are kept", capture.string(),
                 1e-6 * static_cast<double>(session.bytes().size()));
}

/// That the sessions of the capture are of this scene, where they tell of which they are.
void require_scene_of(std::span<const CapturedForces> sessions, const ViewOptions& options,
                      const Scene& scene, const Simulation& simulation) {
  const protocol::ScenePrint given =
      print_of(scene, simulation.mesh(), model_of(scene.deformation).body_to_text(scene.deformation));
  for (const CapturedForces& session : sessions) {
    if (!session.scene || *session.scene == given) continue;
    fail("{}: {} was recorded of another scene, which differs by: {}{}; give the scene file of the recording",
         options.scene->string(), options.capture.string(), protocol::differences(*session.scene, given),
         sessions.size() == 1
             ? ""
             : fmt::format(" (its session of {:.1f} s with tool {})", session.seconds(), session.tool + 1));
  }
}

void report_how_far_off(const CapturedRerun& rerun, const std::filesystem::path& file, const Scene& scene) {
  log::info("{}: stepped again, its forces are within {:.3g} N of those captured, the largest {:.3g} N",
            file.string(), rerun.off(), rerun.largest());
  if (rerun.off() <= kSimilar * rerun.largest()) return;
  if (rerun.tools_taken() < scene.tools.size()) {
    log::warning(
        "{}: that is far off; the capture holds {} of the {} tools of this scene, and what the others did is "
        "not in it. `sim_server run --record` captures them all",
        file.string(), rerun.tools_taken(), scene.tools.size());
  } else if (scene.cutting) {
    log::warning(
        "{}: that is far off: what is shown is not cut as what was felt. Where tissue yields depends on "
        "every "
        "datagram that the server got; capture on its machine, with `sim_server run --record`",
        file.string());
  } else {
    log::warning("{}: that is far off; is it the scene of this capture?", file.string());
  }
}

}  // namespace

int view_capture(const ViewOptions& options) {
  const auto address = read_viewer_address(options.viewer);
  if (!address) fail("--viewer: off would show nothing; give a port");
  require_free(*address);
  require_near(address->endpoint, options.insecure, "whoever reaches it sees the recording");
  const std::vector<CapturedForces> sessions = read_captured_forces(options.capture);
  const CapturedForces& forces = sessions.front();
  SceneFacts facts;
  std::optional<Scene> scene;
  std::optional<Simulation> simulation;
  if (options.scene) {
    scene = read_scene(*options.scene);
    SetupTimes progress{ProgressLine()};
    const auto cache = open_cache(options.cache);
    const auto condensed = open_condensed(options.cache, *scene);
    simulation.emplace(*scene, std::ref(progress), cache ? &*cache : nullptr,
                       condensed ? &*condensed : nullptr);
    require_scene_of(sessions, options, *scene, *simulation);
    simulation->set_cut_options({.keeps_log = false});
    facts = facts_of(*scene, *simulation);
  } else {
    facts.title = options.capture.filename().string();
    facts.file = options.capture.string();
    facts.tools = tools_of(sessions);
  }
  facts.rate_hz = forces.rate_hz();
  facts.recorded = true;
  RecordedSession session(facts);
  auto rerun = simulation ? std::make_unique<CapturedRerun>(*simulation, scene->rate_hz) : nullptr;
  make_session(options.capture, forces.samples.size(), simulation ? &*simulation : nullptr, rerun.get(),
               session);
  if (rerun) report_how_far_off(*rerun, *options.scene, *scene);
  ViewerFeed feed(facts.organ.rest);
  Viewer viewer(*address, "", facts, feed, &session.bytes());
  std::jthread serving([&] {
    take_role(ThreadRole::kPage);
    viewer.run();
  });
  log::info("{}: {} forces, {:.1f} s; the page: http://{}/; Ctrl-C ends it", options.capture.string(),
            forces.samples.size(), forces.seconds(), protocol::to_string(viewer.endpoint()));
  for (const Time start = now(); !wait_for_interrupt(std::chrono::milliseconds(100));) {
    if (options.seconds && to_seconds(now() - start) >= *options.seconds) break;
  }
  viewer.stop();
  return 0;
}

Command view_command() {
  const auto options = std::make_shared<ViewOptions>();
  return {.name = "view",
          .summary = "Open a capture in the live page, to play and search it",
          .footer = "Example: sim_server view F.pcap --scene configs/scenes/liver.toml",
          .options = joined(
              {{{"F.pcap", "pcap or pcapng with a session of Palpate", &options->capture, {.required = true}},
                {"--scene", "Scene file of that session: steps it again, so that the organ moves, too",
                 &options->scene},
                viewer_option(options->viewer),
                {"--insecure", "Let --viewer serve other machines, on a network that you trust",
                 &options->insecure},
                {"--seconds", "Stop after so many seconds (default: at Ctrl-C)", &options->seconds}},
               cache_options(options->cache, "--scene")}),
          .run = [options] {
            if (options->seconds) require_at_least(*options->seconds, 1e-3, "--seconds", "s");
            return view_capture(*options);
          }};
}

}  // namespace palpate::sim
