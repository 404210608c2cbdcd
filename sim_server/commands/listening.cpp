#include "sim_server/commands/listening.h"

#include "protocol/key_file.h"

namespace palpate::sim {

protocol::UdpSocket open_socket(const ListenOptions& options) {
  const protocol::Endpoint endpoint = protocol::resolve(options.address, "--listen");
  protocol::require_key(endpoint, options.key.has_value(), options.insecure, "--listen");
  return protocol::UdpSocket(endpoint);
}

protocol::ServerSessions sessions_for(const ListenOptions& options, double rate_hz,
                                      std::vector<double> tool_radii) {
  return {rate_hz, std::move(tool_radii), protocol::random_value<protocol::Cookies::Secret>(),
          options.key ? protocol::read_keys(*options.key) : std::vector<protocol::Key>{}};
}

std::vector<Option> listen_options(ListenOptions& options, const std::string& insecure) {
  return {{"--listen",
           "ADDR:PORT to listen on (UDP); 0.0.0.0:45130 for other machines",
           &options.address,
           {.shows_default = true}},
          {"--key", "File of keys; clients need one of them, see `sim_server keygen`", &options.key},
          {"--insecure", insecure, &options.insecure}};
}

}  // namespace palpate::sim
