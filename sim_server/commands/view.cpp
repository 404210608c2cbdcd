#include "sim_server/commands/view.h"

#include <algorithm>
#include <fmt/core.h>
#include <limits>
#include <memory>
#include <set>
#include <thread>

#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/log.h"
#include "common/progress.h"
#include "common/realtime.h"
#include "protocol/session.h"
#include "protocol/udp_socket.h"
#include "sim_server/commands/live_view.h"
#include "sim_server/commands/pictures.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/captured_forces.h"
#include "sim_server/serving/captured_steps.h"
#include "sim_server/simulation/setup_times.h"
#include "sim_server/viewer/recorded_session.h"
#include "sim_server/viewer/viewer.h"

namespace palpate::sim {
namespace {

constexpr double kLongestStep = 1;  // s between two answers; what was longer was a pause, or another session
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

/// Exact where they are near; any two, as they come off the wire.
double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  const double about = 1e-9 * (static_cast<double>(to_ns) - static_cast<double>(from_ns));
  return std::abs(about) < 2 * kLongestStep ? 1e-9 * static_cast<double>(to_ns - from_ns) : about;
}

std::size_t tools_in(const std::filesystem::path& capture) {
  std::size_t tools = 1;
  read_captured_steps(
      capture, [](const protocol::ToolState&) {},
      [&](const CapturedAnswer& answer) { tools = std::max<std::size_t>(tools, answer.sample.tool + 1U); });
  return tools;
}

/// A scene that is stepped again with the tool states that its server answered.
class Rerun {
 public:
  explicit Rerun(Simulation& simulation)
      : simulation_(simulation),
        served_(simulation),
        inputs_(simulation.tools()),
        answered_(simulation.tools()),
        captured_(simulation.tools()) {}

  void take(const protocol::ToolState& state) {
    if (state.tool < inputs_.size()) inputs_[state.tool].follow(state);
  }
  /// The tool of this session is in no hand from the step on that the next answer begins.
  void release(std::uint64_t session) { departed_.insert(session); }
  /// Takes an answer for the step to come.
  void take(const CapturedAnswer& answer) {
    if (answer.sample.tool >= inputs_.size())
      fail("the capture has tool {}, and the scene only {}", answer.sample.tool + 1, inputs_.size());
    SessionInput& input = inputs_[answer.sample.tool];
    const double dt = seconds_between(input.state.t_ns, answer.state.t_ns);
    if (answer.begins_step) {
      dt_ = input.session == answer.session && dt > 0 && dt < kLongestStep ? dt : 0;
      drop_departed(answer.t);
    }
    input.session = answer.session;
    answered_[answer.sample.tool] = answer.t;
    input.state = answer.state;
    // What a client asks for besides its force changes nothing here.
    input.state.flags &= protocol::ToolState::kDeviceLost;
    input.fresh = true;
    captured_[answer.sample.tool] = answer.sample.f_W;
  }
  void step(Time t, Picture& picture) {
    const auto outcomes = served_.step(inputs_, dt_);
    ++picture.step;
    picture.simulated += dt_;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      show_tool(inputs_[i], &outcomes[i], to_seconds(t), picture.tools[i]);
      if (!inputs_[i].fresh) continue;
      off_ = std::max(off_, (outcomes[i].force.force - captured_[i]).norm());
      largest_ = std::max(largest_, captured_[i].norm());
      inputs_[i].fresh = false;
    }
    show_organ(simulation_, picture);
  }
  /// Returns how far the forces are from those captured; `largest`: the largest of these, N.
  double off() const { return off_; }
  double largest() const { return largest_; }

 private:
  /// And clients that a server drops, as it has not heard of them for so long.
  void drop_departed(Time t) {
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      const bool silent = t - answered_[i] > protocol::ServerSessions::kTimeout;
      if (silent || departed_.contains(inputs_[i].session)) inputs_[i].session = 0;
    }
  }

  const Simulation& simulation_;
  ServedTools served_;
  std::vector<SessionInput> inputs_;
  std::vector<Time> answered_;  // by tool: when last, in the capture
  std::vector<Vec3> captured_;
  std::set<std::uint64_t> departed_;  // sessions: an answer that was under way is of its own step alone
  double dt_ = 0, off_ = 0, largest_ = 0;
};

/// All of the capture, of about so many answers, into `session`; `rerun` may be null.
void make_session(const std::filesystem::path& capture, std::size_t answers, Rerun* rerun,
                  RecordedSession& session) {
  constexpr std::size_t kBetweenReports = 100;  // answers: 3 s of a session at 30 Hz
  Time t{}, newest{};
  ProgressLine progress("nothing is shown");
  std::size_t taken = 0;
  // Nothing is known of how far each step goes.
  if (rerun == nullptr) session.picture().simulated = std::numeric_limits<double>::quiet_NaN();
  bool pending = false, all = true;
  const auto finish = [&] {
    if (!pending) return;
    if (rerun != nullptr) rerun->step(t, session.picture());
    all = session.add(t) && all;
    pending = false;
  };
  read_captured_steps(
      capture,
      [&](const protocol::ToolState& state) {
        if (rerun != nullptr) rerun->take(state);
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

void report_how_far_off(const Rerun& rerun, const std::filesystem::path& file, const Scene& scene) {
  log::info("{}: stepped again, its forces are within {:.3g} N of those captured, the largest {:.3g} N",
            file.string(), rerun.off(), rerun.largest());
  if (rerun.off() <= kSimilar * rerun.largest()) return;
  if (scene.cutting) {
    log::warning(
        "{}: that is far off: what is shown is not cut as what was felt. Where tissue yields depends on "
        "every "
        "step of the server, and a capture holds those that were answered; without --scene the captured "
        "forces "
        "are shown alone",
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
  const CapturedForces forces = read_captured_forces(options.capture);
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
    simulation->set_cut_options({.keeps_log = false});
    facts = facts_of(*scene, *simulation);
  } else {
    facts.title = options.capture.filename().string();
    facts.file = options.capture.string();
    facts.tools.resize(tools_in(options.capture), Tool{.radius = forces.tool_radius});
  }
  facts.rate_hz = forces.rate_hz();
  facts.recorded = true;
  RecordedSession session(facts);
  auto rerun = simulation ? std::make_unique<Rerun>(*simulation) : nullptr;
  make_session(options.capture, forces.samples.size(), rerun.get(), session);
  if (rerun) report_how_far_off(*rerun, *options.scene, *scene);
  ViewerFeed feed(facts.organ.rest);
  Viewer viewer(*address, "", facts, feed, &session.bytes());
  std::jthread serving([&] {
    name_thread("palpate-view");
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
