#include "haptic_client/session/held_tool.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "common/ages.h"
#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/log.h"
#include "common/realtime.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/session/client_report.h"
#include "haptic_client/session/trace.h"

namespace palpate::client {
namespace {

constexpr double kTraceSeconds = 60;  // a trace holds at most: its memory is reserved at the start
constexpr int kMostStandstills = 30;  // looks of 100 ms

/// Ticks a second: as asked for, or what the device serves if that is less.
double rate_of(const ClientConfig& config) {
  return std::min(config.rate_hz, 1 / to_seconds(row_of(config.device).limits(config.device).min_period));
}

std::size_t stored_ticks(const ClientConfig& config, const ToolFiles& files, std::optional<double> seconds) {
  if (!files.trace) return 0;
  return static_cast<std::size_t>(std::min(seconds.value_or(kTraceSeconds) + 1, kTraceSeconds) *
                                  rate_of(config));
}

}  // namespace

HeldTool::HeldTool(const ClientConfig& config, const ToolFiles& files, std::string name,
                   std::optional<double> seconds, std::unique_ptr<Device> device)
    : config_(config),
      files_(files),
      name_(std::move(name)),
      device_(device ? std::move(device) : row_of(config.device).make(config.device)),
      pipeline_(find_row(extrapolators(), config.method, "method", config.method_where).make(),
                config.workspace, config.device_limits(), config.passivity, config.blend),
      observation_(config.scored_laws(), rate_of(config), config.score_where, config.workspace,
                   stored_ticks(config, files, seconds), config.blend),
      telemetry_(config.device.name, row_of(config.device).make_safe != nullptr, config.method,
                 rate_of(config)),
      loop_(*device_, pipeline_, mailboxes_, observation_, telemetry_, from_seconds(1 / rate_of(config))),
      server_(server_of(config)),
      socket_(protocol::Endpoint{.v6 = server_.v6}),
      recorder_(files.record ? std::make_unique<protocol::Recorder>(
                                   *files.record, protocol::bytes_of_mb(files.record_mb), files.overwrite)
                             : nullptr),
      recording_(recorder_.get()),
      link_(socket_, server_, mailboxes_, key_of(config), recorder_.get()) {
  pipeline_.set_request(observation_.scoring().request());
  pipeline_.set_request({.errors = true});
}

HeldTool::~HeldTool() {
  stop();
}

bool HeldTool::connect(Time patience) {
  if (recorder_) {
    recording_thread_ = std::jthread([this](const std::stop_token& stop) {
      take_role(ThreadRole::kRecording);
      recorder_->run(stop);
    });
  }
  net_thread_ = std::jthread([this] { link_.run(); });
  give_role(net_thread_.native_handle(), ThreadRole::kNetwork);  // `start` says if refused
  for (const Time start = now(); !link_.welcomed;) {
    if (wait_for_interrupt(std::chrono::milliseconds(20))) return false;
    if (now() - start < patience) continue;
    fail_unanswered(link_, config_, name_, patience);
  }
  log::info("{}connected to {}; {} at {:g} Hz with \"{}\"; Ctrl-C ends it", name_, config_.server,
            config_.device.name, rate_of(config_), config_.method);
  return true;
}

void HeldTool::start(Heartbeat* heartbeat) {
  loop_.heartbeat = heartbeat;
  haptic_thread_ = std::jthread([this](const std::stop_token& stop) { loop_.run(stop); });
  const std::string refused = give_role(haptic_thread_.native_handle(), ThreadRole::kHaptic);
  if (!refused.empty()) log::warning("{}{}", name_, refused);
  real_time_ = refused.empty();
}

/// The device first, then the link, so that its last poses still travel, then the recording of them.
void HeldTool::stop() {
  halt();
  if (net_thread_.joinable()) link_.stop();
  net_thread_ = {};
  recording_thread_ = {};
}

/// A loop that stands still leaves its last force on the motors, and may never come back.
void HeldTool::end_if_stuck() {
  const std::uint64_t ticks = loop_.ticks;
  standstills_ = ticks == ticks_ ? standstills_ + 1 : 0;
  ticks_ = ticks;
  if (standstills_ < kMostStandstills) return;
  log::error("{}the haptic loop stands still; the guardian takes the device over", name_);
  std::abort();
}

/// Whoever presses into a wall that gives way should know that the wall is not to blame.
void HeldTool::report_weakness() {
  const bool weak = loop_.weak;
  if (weak && !told_.weak) {
    const double gain = loop_.gain, law = loop_.law_newton;
    const std::string why =
        gain < RenderedFraction::kHalf
            ? fmt::format(
                  "the wall is too stiff for this rate and latency, so it is rendered at {:.0f} % of its "
                  "stiffness; a law with tangents, a faster loop or a softer organ help",
                  100 * gain)
            : fmt::format("more than [limits] force = {:g} N, or than it may change by",
                          config_.device_limits().max_force);
    log::warning(
        "{}for half a second, less than half of the force has been rendered ({:.2f} of {:.2f} N): {}", name_,
        loop_.newest_newton.load(), law, why);
  }
  told_.weak = weak;
}

/// A force that the simulation does not stand behind is not rendered for long, and whoever holds the device
/// should know why.
void HeldTool::report_doubt() {
  const int why = loop_.doubt.load(std::memory_order_relaxed);
  const auto doubt = why == HapticLoop::kNoDoubt ? std::nullopt : std::optional(static_cast<Doubt>(why));
  if (doubt && doubt != doubt_) {
    log::warning(
        "{}the force is not settled: {}; it goes to zero (the server flags its answers, and says more)",
        name_, kDoubtTexts[static_cast<std::size_t>(*doubt)]);
  }
  if (!doubt && doubt_) log::info("{}the force is settled again: soft start", name_);
  doubt_ = doubt;
}

/// Whoever feels less than the tissue gives should know that the link is to blame: too slow, or too narrow.
void HeldTool::report_slow_link() {
  const bool slow = link_.level >= LinkLevel::kLean;
  if (slow && !told_.slow) {
    log::warning(
        "{}the link to {} is slow: samples come without surface and modes, so that a simpler law stands in; "
        "a lower `rate_hz`, or a link of 2 Mbit/s each way, help",
        name_, config_.server);
  }
  told_.slow = slow;
  const bool drops_large = link_.drops_large;
  if (drops_large && !told_.drops_large) log::warning("{}{}", name_, large_datagrams_text());
  told_.drops_large = drops_large;
}

void HeldTool::look() {
  end_if_stuck();
  report_slow_link();
  const std::int64_t age = loop_.newest_age_ns;
  if (loop_.paused != told_.paused) {
    told_.paused = loop_.paused;
    log::info("{}{}", name_,
              told_.paused ? "paused at the server: force goes to zero, and the tool stays where it is"
                           : "the server goes on: soft start");
  }
  if (age > kOutage.count() && !told_.silent)
    log::warning("{}no samples from {}: force goes to zero; asking again", name_, config_.server);
  if (age >= 0 && age < kOutage.count() && told_.silent)
    log::info("{}{} is back: soft start", name_, config_.server);
  told_.silent = age > kOutage.count();
  const Fault fault = loop_.fault;
  if (fault != Fault::kNone && fault_ == Fault::kNone) {
    log::warning("{}force latched off ({}); when it is safe, re-arm with `kill -USR1 {}`", name_,
                 name_of(fault), getpid());
  }
  fault_ = fault;
  report_weakness();
  report_doubt();
  recording_.look();
  link_.watcher.poll(name_);
  if (const char* status = device_->status(); status != device_status_) {
    if (status[0] != 0) log::info("{}{}", name_, status);
    device_status_ = status;
  }
}

std::string HeldTool::progress() const {
  const std::int64_t age = loop_.newest_age_ns;
  return fmt::format("|F| {:5.2f} N  age {:>5} ms  ticks {} ({} missed)", loop_.newest_newton.load(),
                     age < 0 ? "-" : fmt::format("{:.1f}", static_cast<double>(age) / 1e6),
                     loop_.ticks.load(), loop_.missed.load());
}

Json HeldTool::report() const {
  Json tool = tool_report(config_, pipeline_, observation_);
  tool["loop"] = loop_report(rate_of(config_), loop_.stats());
  tool["loop"]["real_time"] = real_time_;
  tool["link"] = link_report(link_);
  const LinkFigures& figures = link_.figures();
  tool["link"]["gaps"] = figures.gaps;
  tool["link"]["longest_gap_ms"] = 1e3 * to_seconds(figures.longest_gap);
  tool["link"]["surfaces"] = figures.surfaces;
  tool["link"]["page_requests"] = figures.page_requests;
  tool["link"]["drops_large"] = figures.drops_large();
  tool["link"]["rate_hz"] = link_.session().welcome().rate_hz;
  const PipelineStats& stats = pipeline_.stats();
  tool["link"]["first_itself_s"] = stats.first_itself > Time{}
                                       ? Json(to_seconds(stats.first_itself - stats.first_published))
                                       : Json(nullptr);
  tool["safety"]["cut_by_motors"] = device_->cut_by_motors();
  if (recorder_) tool["recording"] = protocol::recording_report(*recorder_);
  return tool;
}

void HeldTool::write_files() const {
  if (!files_.trace) return;
  TraceWriter trace(*files_.trace, observation_.scoring().names());
  for (const TickRecord& tick : observation_.record()) trace.add(tick);
  trace.finish();
}

}  // namespace palpate::client
