#include "haptic_client/client.h"

#include <nlohmann/json.hpp>
#include <random>
#include <thread>
#include <unistd.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/log.h"
#include "common/realtime.h"
#include "common/text.h"
#include "haptic_client/client_report.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/net_link.h"
#include "haptic_client/trace.h"
#include "protocol/recording_report.h"

namespace palpate::client {
namespace {

constexpr int kPriority = 80;
constexpr double kTraceSeconds = 60;
constexpr Time kWelcomePatience = std::chrono::seconds(5);
constexpr std::int64_t kSilentNs = 300'000'000;

protocol::Endpoint any_address(const protocol::Endpoint& server) {
  return {.v6 = server.v6};
}

void warn_if_refused(const std::string& refused) {
  if (!refused.empty()) log::warning("{}", refused);
}

std::uint64_t random_number() {
  std::random_device device;
  return (std::uint64_t{device()} << 32 | device()) | 1;
}

/// Waits until the server lets us in. Throws when nobody does within five seconds; false on Ctrl-C.
bool wait_for_welcome(const NetLink& link, const std::string& server) {
  for (const Time start = now(); !link.welcomed;) {
    if (wait_for_interrupt(std::chrono::milliseconds(20))) return false;
    if (now() - start < kWelcomePatience) continue;
    if (link.refused == static_cast<int>(protocol::RefuseReason::kNoFreeTool)) {
      fail_at_run_time("the server at {} has no free tool: another client holds it; end that one first",
                       server);
    }
    fail_at_run_time("no answer from a server at {} within 5 s; is `sim_server run` up, and UDP open there?",
                     server);
  }
  return true;
}

/// Tells, while the loop runs: a progress line, and once each the loss and the return of the server and a
/// latched fault.
class Watcher {
 public:
  Watcher(HapticLoop& loop, const Device& device, const protocol::Recorder* recorder,
          const std::string& server)
      : loop_(loop), device_(device), recording_(recorder), server_(server) {}

  void look(double seconds) {
    const std::int64_t age = loop_.newest_age_ns;
    if (age > kSilentNs && !silent_)
      log::warning("no samples from {}: force goes to zero; asking again", server_);
    if (age >= 0 && age < kSilentNs && silent_) log::info("{} is back: soft start", server_);
    silent_ = age > kSilentNs;
    const Fault fault = loop_.fault;
    if (fault != Fault::kNone && fault_ == Fault::kNone) {
      log::warning("force latched off ({}); when it is safe, re-arm with `kill -USR1 {}`", name_of(fault),
                   getpid());
    }
    fault_ = fault;
    recording_.look();
    if (const char* status = device_.status(); status != device_status_) {
      if (status[0] != 0) log::info("{}", status);
      device_status_ = status;
    }
    const bool terminal = isatty(STDOUT_FILENO) != 0;
    if (seconds < next_) return;
    next_ = seconds + (terminal ? 0.2 : 5);
    fmt::print("{}haptic_client: {:6.1f} s  |F| {:5.2f} N  age {:5.1f} ms  ticks {} ({} missed){}",
               terminal ? "\r" : "", seconds, loop_.newest_newton.load(),
               static_cast<double>(std::max<std::int64_t>(age, 0)) / 1e6, loop_.ticks.load(),
               loop_.missed.load(), terminal ? "  " : "\n");
    std::fflush(stdout);
  }

 private:
  HapticLoop& loop_;
  const Device& device_;
  const char* device_status_ = "";
  protocol::RecordingWatcher recording_;
  std::string server_;
  bool silent_ = false;
  Fault fault_ = Fault::kNone;
  double next_ = 0;
};

void watch(HapticLoop& loop, const Device& device, const protocol::Recorder* recorder,
           const std::string& server, std::optional<double> seconds) {
  Watcher watcher(loop, device, recorder, server);
  for (const Time start = now();;) {
    const double elapsed = to_seconds(now() - start);
    if (seconds && elapsed >= *seconds) break;
    watcher.look(elapsed);
    const double left = seconds ? *seconds - elapsed : 0.1;
    if (wait_for_interrupt(from_seconds(std::min(left, 0.1)))) break;
    if (take_rearm_request()) loop.rearm = true;
  }
  if (isatty(STDOUT_FILENO) != 0) fmt::print("\n");
}

/// Runs the haptic loop in a thread of its own until Ctrl-C or the end of the time.
void drive(HapticLoop& loop, const Device& device, const protocol::Recorder* recorder,
           const ClientConfig& config, const ClientOptions& options) {
  log::info("connected to {}; {} at {:g} Hz with \"{}\"; Ctrl-C ends it", config.server, config.device.name,
            config.rate_hz, config.method);
  std::jthread haptic([&](const std::stop_token& stop) { loop.run(stop); });
  warn_if_refused(make_realtime(haptic.native_handle(), "palpate-haptic", kPriority));
  warn_if_refused(lock_memory());  // after the threads, whose stacks a small limit would not hold
  watch(loop, device, recorder, config.server, options.seconds);
}

void write_trace(const std::filesystem::path& file, const Observation& observation) {
  TraceWriter trace(file, observation.scoring().names());
  for (const TickRecord& tick : observation.record()) trace.add(tick);
  trace.finish();
}

}  // namespace

int run_client(const ClientConfig& config, const ClientOptions& options) {
  require_distinct({{"--report", options.report}, {"--trace", options.trace}, {"--record", options.record}});
  if (options.report) check_writable(*options.report);
  if (options.trace) check_writable(*options.trace);
  const protocol::Endpoint server = protocol::resolve(config.server, config.server_where);
  if (server.port == 0)
    fail("{}: \"{}\": a server has a port from 1 to 65535", config.server_where, config.server);
  const DeviceRow& row = find_row(devices(), config.device.name, "device", config.device.where);
  const auto device = row.make(config.device);
  Pipeline pipeline(find_row(extrapolators(), config.method, "method", config.method_where).make(),
                    config.workspace, config.device_limits(), config.passivity);
  HapticMailboxes mailboxes;
  const double kept =
      options.trace ? std::min(options.seconds.value_or(kTraceSeconds) + 1, kTraceSeconds) : 0;
  Observation observation(config.scored_laws(), config.rate_hz, config.score_where,
                          static_cast<std::size_t>(kept * config.rate_hz));
  const Time period = std::max(from_seconds(1 / config.rate_hz), row.limits(config.device).min_period);
  HapticLoop loop(*device, pipeline, mailboxes, observation, period);
  protocol::UdpSocket socket(any_address(server));
  const auto recorder = options.record ? std::make_unique<protocol::Recorder>(*options.record) : nullptr;
  NetLink link(socket, server, mailboxes, random_number(), recorder.get());
  {
    std::jthread recording;
    if (recorder) recording = std::jthread([&](const std::stop_token& stop) { recorder->run(stop); });
    std::jthread net([&] { link.run(); });
    const struct StopNet {  // also when waiting throws
      NetLink& link;
      ~StopNet() { link.stop(); }
    } stop_net{link};
    if (wait_for_welcome(link, config.server)) drive(loop, *device, recorder.get(), config, options);
  }
  Json tool = tool_report(config, pipeline, observation);
  tool["loop"] = loop_report(config.rate_hz, loop.stats());
  Json report = {
      {"server", config.server}, {"tools", Json::array({tool})}, {"link", link_report(link.stats())}};
  if (recorder) report["recording"] = protocol::recording_report(*recorder);
  print_report(report);
  if (options.trace) write_trace(*options.trace, observation);
  if (options.report) write_json(*options.report, report);
  return 0;
}

}  // namespace palpate::client
