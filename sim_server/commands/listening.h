#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/program.h"
#include "protocol/session.h"
#include "protocol/udp_socket.h"

namespace palpate::sim {

/// Address of a server, and the clients that it admits.
struct ListenOptions {
  std::string address = "127.0.0.1:45130";
  std::optional<std::filesystem::path> key;  ///< file of the keys of which clients must have one
  bool insecure = false;                     ///< serve other machines without
};

/// A socket there. Throws `Error` where it cannot be had, or other machines could reach it without a key.
protocol::UdpSocket open_socket(const ListenOptions& options);

/// Sessions with the keys asked for, and cookies of this run. Throws `Error` for a key file that is wrong.
protocol::ServerSessions sessions_for(const ListenOptions& options, double rate_hz,
                                      std::vector<double> tool_radii);

/// `--listen`, `--key` and `--insecure`, of which the help says `insecure`.
std::vector<Option> listen_options(ListenOptions& options,
                                   const std::string& insecure = "Serve other machines without a key");

}  // namespace palpate::sim
