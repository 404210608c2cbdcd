#include "haptic_client/commands/replay.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/error.h"
#include "common/log.h"
#include "common/progress.h"
#include "common/text.h"
#include "haptic_client/commands/overrides.h"
#include "haptic_client/evaluation/resampler.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/session/client_report.h"
#include "haptic_client/session/trace.h"
#include "protocol/recorder.h"
#include "protocol/udp_socket.h"

namespace palpate::client {
namespace {

constexpr double kFastest = 20000;             // Hz
constexpr double kSameRate = 0.02;             // of the rate
constexpr std::uint64_t kSearchAround = 4096;  // ticks between two looks at the progress line

std::string describe(const CapturedRun& run, std::size_t index) {
  return fmt::format("{}: client {}, {} ticks from {} ({:.0f} Hz), {} samples", index + 1,
                     protocol::to_string(run.client), run.ticks, run.first_tick, run.ticks_hz(), run.samples);
}

/// The session asked for, or the longest; says which when there are several.
std::size_t index_of(const CaptureSurvey& found, const ReplayOptions& options) {
  const auto count = static_cast<int>(found.runs.size());
  const auto longest =
      std::ranges::max_element(found.runs, [](const auto& a, const auto& b) { return a.ticks < b.ticks; });
  if (options.session && (*options.session < 1 || *options.session > count))
    fail("--session: {} has {} session{}, there is no number {}", options.capture.string(), count,
         count == 1 ? "" : "s", *options.session);
  const auto chosen = options.session ? static_cast<std::size_t>(*options.session - 1)
                                      : static_cast<std::size_t>(longest - found.runs.begin());
  if (count > 1) {
    log::info("{} holds {} sessions; replaying number {}, --session chooses another",
              options.capture.string(), count, chosen + 1);
    for (std::size_t i = 0; i < found.runs.size(); ++i) log::info("  {}", describe(found.runs[i], i));
  }
  if (found.runs[chosen].ticks == 0)
    fail("--session: number {} in {} has no tool states", chosen + 1, options.capture.string());
  return chosen;
}

/// A recording that grew beyond its size goes on in another file.
void say_if_it_goes_on(const std::filesystem::path& capture) {
  const std::filesystem::path next = protocol::Recorder::path_of(capture, 2);
  if (!std::filesystem::exists(next)) return;
  log::warning(
      "{}: beside it lies {}, in which a recording of this name goes on; to replay both: "
      "`mergecap -a -F pcap -w ALL.pcap {} {}`",
      capture.string(), next.filename().string(), capture.string(), next.string());
}

}  // namespace

ChosenSession choose_session(const ReplayOptions& options) {
  require_distinct({{"CAPTURE", options.capture}, {"--out", options.out}, {"--report", options.report}});
  if (options.report) check_writable(*options.report, Contents::kReport);
  if (options.out) check_writable(*options.out, Contents::kTable);
  ProgressLine progress;
  CaptureSurvey found =
      survey(options.capture, [&](double fraction) { progress("reading the capture", fraction); });
  const std::size_t index = index_of(found, options);
  if (!found.trouble.empty()) log::warning("{}: {}", options.capture.string(), found.trouble);
  say_if_it_goes_on(options.capture);
  return {std::move(found), index};
}

double nominal_rate(double captured_hz, double requested_hz) {
  const bool near = std::abs(captured_hz - requested_hz) <= kSameRate * requested_hz;
  return std::clamp(near ? requested_hz : captured_hz, 1.0, kFastest);
}

namespace {

/// The captured ticks as they are, or at the rate asked for.
class TickSource {
 public:
  TickSource(CapturedSession& session, std::optional<double> rate_hz) : session_(session) {
    if (rate_hz) resampler_.emplace(session, *rate_hz);
  }
  bool next(CapturedTick& out) { return resampler_ ? resampler_->next(out) : session_.next(out); }

 private:
  CapturedSession& session_;
  std::optional<Resampler> resampler_;
};

std::uint64_t run_ticks(CapturedSession& session, std::optional<double> rate_hz, Pipeline& pipeline,
                        Observation& observation, TraceWriter* trace) {
  TickSource source(session, rate_hz);
  ProgressLine progress;
  CapturedTick tick;
  std::uint64_t ticks = 0;
  while (source.next(tick)) {
    const TickResult result =
        pipeline.render(tick.state, tick.arrived ? &*tick.arrived : nullptr, tick.pages);
    // What a tick is held against is known when the next samples have come.
    const TickRecord* const leaving = observation.leaving();
    if (trace != nullptr && leaving != nullptr) trace->add(*leaving);
    observation.tick(result, Time::zero(), 0);
    if (++ticks % kSearchAround == 0) progress("replaying", session.fraction());
  }
  if (trace != nullptr) {
    for (const TickRecord& last : observation.record()) trace->add(last);
  }
  progress("replaying", 1);
  return ticks;
}

Json describe_capture(const CaptureSurvey& found, const CapturedRun& run, const CapturedSession& session,
                      std::uint64_t ticks, double rate_hz, bool exact) {
  const CapturedSession::Missing& missing = session.missing();
  return {{"client", protocol::to_string(run.client)},
          {"packets", found.packets},
          {"ours", found.ours},
          {"refused", found.refused},
          {"omitted", found.omitted},
          {"other_traffic", found.other},
          {"sessions", found.runs.size()},
          {"tool_states", run.ticks},
          {"force_samples", run.samples},
          {"rate_hz", rate_hz},
          {"ticks", ticks},
          {"own_ticks", exact},
          {"missing_ticks", missing.ticks},
          {"left_out_ticks", missing.left_out},
          {"missing_samples", missing.samples},
          {"missing_pages", missing.pages},
          {"undated_pages", missing.undated},
          {"backward_ticks", missing.backwards},
          {"link_lost", run.lost()},
          {"link_reordered", run.reordered()},
          {"link_duplicated", run.duplicated()}};
}

/// Prints whether these are the forces that the client wrote, or what keeps them from being.
void say_how_exact(const Json& capture, const CapturedRun& run, const std::string& file) {
  fmt::print("haptic_client: {} ticks at {:.6g} Hz, {} samples of client {}\n",
             capture["ticks"].get<std::uint64_t>(), capture["rate_hz"].get<double>(), run.samples,
             protocol::to_string(run.client));
  if (run.first_tick > 1)
    log::info("{}: begins in mid-session, at tick {}: the force starts softly there", file, run.first_tick);
  const auto count = [&](const char* key) { return capture[key].get<std::uint64_t>(); };
  if (count("omitted") > 0)
    log::warning("{}: holds more sessions than can be told apart; {} datagrams were left out", file,
                 count("omitted"));
  if (count("missing_ticks") + count("missing_samples") + count("missing_pages") + count("backward_ticks") >
      0) {
    log::warning(
        "{}: {} ticks, {} samples and {} pages of the surface are missing, {} ticks have times that jump: "
        "the "
        "forces differ from those rendered there",
        file, count("missing_ticks"), count("missing_samples"), count("missing_pages"),
        count("backward_ticks"));
  }
  if (count("left_out_ticks") + count("undated_pages") > 0) {
    log::warning(
        "{}: {} of {} ticks are not in the capture, as a slow link carried about one a step (level sparse), "
        "and "
        "{} pages came when ticks did not tell which they had (levels lean and sparse): until the soft start "
        "of "
        "the next session, the forces differ from those rendered there",
        file, count("left_out_ticks"), count("left_out_ticks") + count("ticks"), count("undated_pages"));
  }
}

/// A client file may be of another session.
void say_if_rates_differ(const ReplayOptions& options, double captured_hz, double client_hz) {
  if (options.client.empty() || options.rate_hz || nominal_rate(captured_hz, client_hz) == client_hz) return;
  log::warning(
      "{}: has {:.4g} ticks a second, and {} says `rate_hz = {:g}`: is it the client file of this session? "
      "What is computed has the ticks of the capture; `--rate {:g}` takes the rate of the file",
      options.capture.string(), captured_hz, options.client, client_hz, client_hz);
}

}  // namespace

int replay(const ClientConfig& config, const ReplayOptions& options) {
  const ChosenSession chosen = choose_session(options);
  const CapturedRun& run = chosen.run();
  const double captured_hz = run.ticks_hz(), rate_hz = options.rate_hz.value_or(captured_hz);
  say_if_rates_differ(options, captured_hz, config.rate_hz);
  const bool exact = captured_hz == 0 || std::abs(rate_hz - captured_hz) <= kSameRate * captured_hz;
  const double ticks_hz = exact ? nominal_rate(captured_hz, config.rate_hz) : rate_hz;

  Pipeline pipeline(find_row(extrapolators(), config.method, "method", config.method_where).make(),
                    config.workspace, config.device_limits(), config.passivity, config.blend);
  const std::size_t keep = options.out ? PastTicks::longest_wait(ticks_hz) + 1 : 0;
  Observation observation(config.scored_laws(), ticks_hz, config.score_where, config.workspace, keep,
                          config.blend);
  CapturedSession session(options.capture, chosen.index);
  std::optional<TraceWriter> trace;
  if (options.out) trace.emplace(*options.out, observation.scoring().names());
  const std::uint64_t ticks = run_ticks(session, exact ? std::nullopt : std::optional(rate_hz), pipeline,
                                        observation, trace ? &*trace : nullptr);
  if (trace) trace->finish();

  const Json report = {{"capture", describe_capture(chosen.found, run, session, ticks, ticks_hz, exact)},
                       {"tools", Json::array({tool_report(config, pipeline, observation)})}};
  say_how_exact(report["capture"], run, options.capture.string());
  print_report(report);
  if (options.report) write_json(*options.report, report);
  return 0;
}

Command replay_command() {
  struct Requested {
    Overrides overrides;
    ReplayOptions options;
    bool live = false;
  };
  const auto requested = std::make_shared<Requested>();
  Overrides& overrides = requested->overrides;
  ReplayOptions& options = requested->options;
  return {
      .name = "replay",
      .summary =
          "Run a captured session again: offline, the same forces bit by bit; or --live, its tool "
          "against a server",
      .footer = list_of_laws() +
                "Examples: haptic_client replay --live liver.pcap --to 192.168.1.20:45130 --key "
                "palpate.key\n"
                "          haptic_client replay liver.pcap --method constant --out forces.csv",
      .options = {{"CAPTURE",
                   "pcap or pcapng: of --record, sim_server record, tcpdump ...",
                   &options.capture,
                   {.required = true}},
                  {"--client",
                   "Client file of the session: workspace, limits and laws to score (default: all defaults)",
                   &overrides.file},
                  {"--method", "How to extrapolate the force, see below", &overrides.method},
                  {"--rate", "Ticks per second, 1 to 20000 (default, or within 2 %: the capture's own ticks)",
                   &options.rate_hz},
                  {"--out", "CSV to write, a row a tick; with --live, of the last minute", &options.out},
                  {"--session", "Which session, where the capture has several", &options.session},
                  {"--report", "Write figures to this JSON file", &options.report},
                  {"--live", "Play the captured tool to a live server, in real time; nothing is moved",
                   &requested->live},
                  {"--to",
                   "ADDR:PORT of that server (default 127.0.0.1:45130)",
                   &overrides.server,
                   {.needs = "--live"}},
                  {"--key", "File of the key that the server has", &overrides.key, {.needs = "--live"}},
                  insecure_option(overrides, "--live")},
      .run = [requested] {
        const std::optional<double>& rate_hz = requested->options.rate_hz;
        if (rate_hz) require_within(*rate_hz, 1, 20000, "--rate", "Hz");
        if (requested->live && rate_hz) fail("--rate: a live replay has the capture's own rate");
        requested->options.client = requested->overrides.file;
        return (requested->live ? replay_live : replay)(read_config(requested->overrides),
                                                        requested->options);
      }};
}

}  // namespace palpate::client
