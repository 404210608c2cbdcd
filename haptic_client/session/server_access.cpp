#include "haptic_client/session/server_access.h"

#include "common/error.h"
#include "protocol/key_file.h"
#include "protocol/udp_socket.h"

namespace palpate::client {
using protocol::UdpSocket;

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

namespace {

/// A Hello of a version that there is not: every server answers it, also one with other keys, with the
/// version that it speaks.
UdpSocket::Answer answer_to_no_version(const protocol::Endpoint& server) {
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  const std::size_t size = protocol::encode({}, protocol::Hello{}, bytes);
  bytes[protocol::kVersionAt] = std::byte{0};
  return UdpSocket::answer_of(server, {bytes.data(), size}, std::chrono::milliseconds(500));
}

bool is_server(const UdpSocket::Answer& answer) {
  protocol::Datagram datagram;
  return protocol::decode(answer.bytes, datagram) == protocol::Verdict::kAccepted &&
         std::holds_alternative<protocol::Refuse>(datagram.message);
}

/// Fails where an answer came that is not of who has our key.
void fail_mismatched(const NetLink& link, const ClientConfig& config) {
  if (link.key_mismatch == static_cast<int>(protocol::KeyMismatch::kNoTag)) {
    fail_at_run_time(
        "the server at {} answers without a key, so nothing of it is obeyed: start it with the same key "
        "(--key FILE) as {} here, or both without one",
        config.server, config.key->string());
  }
  if (link.key_mismatch == static_cast<int>(protocol::KeyMismatch::kOtherKey)) {
    fail_at_run_time("the server at {} answers with another key than {}: copy its key file here (scp -p)",
                     config.server, config.key->string());
  }
}

}  // namespace

std::string remedy_of(const std::error_code& error) {
  if (error == std::errc::connection_refused)
    return "start `sim_server run` there, or give the port that it listens at";
  if (error == std::errc::operation_not_permitted)
    return "a firewall of this machine rejects it (`nft list ruleset` shows it): let UDP to that port out";
  if (error == std::errc::permission_denied)
    return "a firewall on the way rejects it, or it is a broadcast address: let UDP to that port through, or "
           "give the address of one machine";
  if (error == std::errc::host_unreachable)
    return "the machine is off, or a firewall on it or on the way rejects UDP: `ping` it; if it answers, let "
           "UDP to that port through";
  if (error == std::errc::network_unreachable)
    return "this machine has no way there: is the address right, and this machine in the same network or "
           "VPN?";
  return "is the address right, and this machine in the same network?";
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
    const std::error_code error(reason, std::generic_category());
    fail_at_run_time("nothing can be sent to {}: {}; {}", config.server, error.message(), remedy_of(error));
  }
  fail_mismatched(link, config);
  const UdpSocket::Answer answer = answer_to_no_version(server_of(config));
  if (answer.error) {
    const bool refused = answer.error == std::errc::connection_refused;
    fail_at_run_time("{}{} {} ({}): {}", name, refused ? "nothing listens at" : "nothing reaches",
                     config.server, answer.error.message(), remedy_of(answer.error));
  }
  if (is_server(answer)) {
    fail_at_run_time(
        "the server at {} is there, and answers nothing {}: copy its key file here (scp -p), and give it "
        "with --key FILE",
        config.server,
        config.key ? fmt::format("to the key in {}, so it has another key", config.key->string())
                   : "without its key");
  }
  fail_at_run_time(
      "no answer from a server at {} within {:g} s; is `sim_server run` up, {}and UDP open there?",
      config.server, to_seconds(waited),
      config.key ? "with the same key, " : "without a key (or give it here: --key FILE), ");
}

}  // namespace palpate::client
