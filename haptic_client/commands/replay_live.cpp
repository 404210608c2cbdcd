#include <algorithm>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/clock.h"
#include "common/interrupt.h"
#include "common/progress.h"
#include "haptic_client/commands/replay.h"
#include "haptic_client/evaluation/captured_hand.h"
#include "haptic_client/session/client_report.h"
#include "haptic_client/session/held_tool.h"

namespace palpate::client {
namespace {

/// Returns the client of the file, but that the hand is the captured one, in the frame of the world.
ClientConfig with_captured_hand(ClientConfig config, double captured_hz) {
  config.rate_hz = std::clamp(nominal_rate(captured_hz, config.rate_hz), kMinRate, kMaxRate);
  config.workspace = {};
  config.device.name = "simulated";
  config.device.port.clear();
  return config;
}

/// Plays until the capture, or somebody's patience, ends.
void play(HeldTool& tool, double seconds) {
  ProgressLine progress;
  for (const Time start = now();;) {
    const double elapsed = to_seconds(now() - start);
    if (elapsed >= seconds) break;
    progress("playing", elapsed / seconds);
    tool.look();
    if (wait_for_interrupt(from_seconds(std::min(seconds - elapsed, 0.1)))) break;
  }
  progress("playing", 1);
}

}  // namespace

int replay_live(const ClientConfig& requested, const ReplayOptions& options) {
  const ChosenSession chosen = choose_session(options);
  CapturedSession session(options.capture, chosen.index);
  auto hand = std::make_unique<CapturedHand>(session);
  const double seconds = hand->seconds();
  const ClientConfig config = with_captured_hand(requested, chosen.run().ticks_hz());
  HeldTool tool(config, {.trace = options.out, .record = {}}, "", seconds, std::move(hand));
  if (!tool.connect()) return 0;
  fmt::print("haptic_client: playing {:.1f} s of {} at {:g} Hz; nothing is moved\n", seconds,
             options.capture.string(), config.rate_hz);
  std::fflush(stdout);
  tool.start(nullptr);
  play(tool, seconds);
  tool.stop();
  const Json report = {{"server", config.server}, {"tools", Json::array({tool.report()})}};
  print_report(report);
  tool.write_files();
  if (options.report) write_json(*options.report, report);
  return 0;
}

}  // namespace palpate::client
