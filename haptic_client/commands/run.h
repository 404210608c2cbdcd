#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "common/program.h"
#include "haptic_client/session/client_config.h"

namespace palpate::client {

/// Options of `haptic_client run`, beyond the configuration.
struct ClientOptions {
  std::optional<double> seconds;  ///< stop after so long in contact with the server; absent: at Ctrl-C
  std::optional<std::filesystem::path> report;  ///< JSON written at the end
  std::optional<std::filesystem::path> trace;   ///< CSV of the last minute, a row a tick; a file each tool
  std::optional<std::filesystem::path> record;  ///< capture of every datagram; a file each tool
  std::optional<double> record_mb;              ///< size at which a recording goes on in a new file
  bool force = false;                           ///< overwrites a capture that is there
};

/// Runs one tool for each of `configs` (at least one): connects, runs the haptic loops until Ctrl-C or
/// `seconds`, reports. Throws `Error`. Returns the exit code.
int run_client(const std::vector<ClientConfig>& configs, const ClientOptions& options);

/// `haptic_client run`.
Command run_command();

}  // namespace palpate::client
