#pragma once
#include <filesystem>
#include <optional>

#include "haptic_client/client_config.h"

namespace palpate::client {

/// What `haptic_client run` was asked for, beyond the configuration.
struct ClientOptions {
  std::optional<double> seconds;  ///< stop after so long in contact with the server; absent: at Ctrl-C
  std::optional<std::filesystem::path> report;  ///< JSON written at the end
  std::optional<std::filesystem::path> trace;   ///< CSV of the last minute, a row a tick
  std::optional<std::filesystem::path> record;  ///< capture of every datagram
};

/// Connects, runs the haptic loop until Ctrl-C or `seconds`, reports. Throws `Error`. Returns the exit code.
int run_client(const ClientConfig& config, const ClientOptions& options);

}  // namespace palpate::client
