#include "haptic_client/session/server_access.h"

#include "common/error.h"
#include "protocol/key_file.h"
#include "protocol/udp_socket.h"

namespace palpate::client {

protocol::Endpoint server_of(const ClientConfig& config) {
  const protocol::Endpoint server = protocol::resolve(config.server, config.server_where);
  if (server.port == 0)
    fail("{}: \"{}\": a server has a port from 1 to 65535", config.server_where, config.server);
  protocol::require_key(server, config.key.has_value(), config.insecure, config.server_where);
  return server;
}

protocol::Key key_of(const ClientConfig& config) {
  return config.key ? protocol::read_keys(*config.key).back() : protocol::Key{};
}

void fail_unanswered(const NetLink& link, const ClientConfig& config, const std::string& name, Time waited) {
  if (link.refused == static_cast<int>(protocol::RefuseReason::kNoFreeTool)) {
    fail_at_run_time(
        "{}the server at {} has no free tool: other clients or devices hold all of its [[tool]]s; end one "
        "of "
        "them, or add a [[tool]] to its scene",
        name, config.server);
  }
  if (const int version = link.other_version; version != 0) {
    fail_at_run_time(
        "the server at {} speaks version {} of the protocol, this program version {}; install the same "
        "release of both",
        config.server, version, protocol::kProtocolVersion);
  }
  if (const int reason = link.unsendable; reason != 0) {
    fail_at_run_time(
        "nothing can be sent to {}: {}; is the address right, and this machine in the same network?",
        config.server, std::generic_category().message(reason));
  }
  if (const std::error_code answer =
          protocol::UdpSocket::answer_of(server_of(config), std::chrono::milliseconds(200))) {
    const bool refused = answer == std::errc::connection_refused;
    fail_at_run_time("{}nothing listens at {} ({}): {}", name, config.server, answer.message(),
                     refused ? "start `sim_server run` there, or give the port that it listens at"
                             : "a router or firewall on the way rejects it; open UDP there");
  }
  fail_at_run_time(
      "no answer from a server at {} within {:g} s; is `sim_server run` up, {}and UDP open there?",
      config.server, to_seconds(waited),
      config.key ? "with the same key, " : "without a key (or give it here: --key FILE), ");
}

}  // namespace palpate::client
