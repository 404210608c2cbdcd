#include "sim_server/commands/replay.h"

#include <fmt/core.h>
#include <memory>
#include <thread>

#include "common/clock.h"
#include "common/interrupt.h"
#include "common/log.h"
#include "common/realtime.h"
#include "sim_server/serving/force_player.h"
#include "sim_server/serving/net_link.h"

namespace palpate::sim {
namespace {

constexpr Time kLast = std::chrono::milliseconds(200);  // for the last sample to arrive

/// Tells who comes, and ends with the recording.
void watch(const ForcePlayer& player, const NetLink& link, std::optional<double> seconds) {
  bool held = false;
  for (const Time start = now(); !wait_for_interrupt(std::chrono::milliseconds(100));) {
    if (link.tools[0].held != held) {
      held = link.tools[0].held;
      log::info("{}", held ? "a client took the tool: playing"
                           : "the client is gone; the next one hears it from the start");
    }
    if (player.ended) {
      sleep_until(now() + kLast);
      return;
    }
    if (seconds && to_seconds(now() - start) >= *seconds) return;
  }
}

}  // namespace

int serve_replay(const ReplayOptions& options) {
  const CapturedForces forces = read_captured_forces(options.capture).front();
  protocol::ServerSessions sessions = sessions_for(options.listen, forces.rate_hz(), {forces.tool_radius});
  if (forces.scene) sessions.set_scene(*forces.scene);
  protocol::UdpSocket socket = open_socket(options.listen);
  SimMailboxes mailboxes;
  ForcePlayer player(forces, mailboxes);
  NetLink link(socket, std::move(sessions), mailboxes, nullptr);
  std::jthread net([&] {
    take_role(ThreadRole::kNetwork);
    link.run();
  });
  std::jthread playing([&](const std::stop_token& stop) {
    take_role(ThreadRole::kSimulation);
    player.run(stop);
  });
  log::info("{}: {} forces, {:.1f} s at {:.1f} Hz; listening on {} (UDP)", options.capture.string(),
            forces.samples.size(), forces.seconds(), forces.rate_hz(), protocol::to_string(socket.local()));
  watch(player, link, options.seconds);
  playing.request_stop();
  playing.join();
  link.stop();
  net.join();
  fmt::print("sim_server: played {} of {} forces\n", player.played.load(), forces.samples.size());
  return 0;
}

Command replay_command() {
  const auto options = std::make_shared<ReplayOptions>();
  return {
      .name = "replay",
      .summary = "Play the forces of a capture to a live client and its device",
      .footer =
          "The forces come in their own time, wherever the tool is now; they carry no tangents. The "
          "client's limits\n"
          "hold as ever, and its passivity takes energy out that a force without a wall may bring "
          "in.\n"
          "Example: sim_server replay --serve F.pcap",
      .options = joined(
          {{{"--serve", "pcap or pcapng with a session of Palpate", &options->capture, {.required = true}}},
           listen_options(options->listen),
           {{"--seconds", "Stop after so many seconds (default: when all was played)", &options->seconds}}}),
      .run = [options] {
        if (options->seconds) require_at_least(*options->seconds, 1e-3, "--seconds", "s");
        return serve_replay(*options);
      }};
}

}  // namespace palpate::sim
