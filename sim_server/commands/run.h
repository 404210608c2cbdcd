#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "common/program.h"
#include "sim_server/commands/cache.h"
#include "sim_server/commands/listening.h"

namespace palpate::sim {

/// Options of `sim_server run`.
struct ServerOptions {
  std::filesystem::path scene;
  ListenOptions listen;
  std::optional<double> seconds;                   ///< stop after so long; absent: at Ctrl-C
  std::optional<std::filesystem::path> report;     ///< JSON written at the end
  std::optional<std::filesystem::path> resection;  ///< CSV of what was removed, written at the end
  std::optional<std::filesystem::path> record;     ///< capture of every datagram
  std::optional<double> record_mb;                 ///< size at which it goes on in a new file
  bool force = false;                              ///< overwrites a capture that is there
  CacheOptions cache;
  std::string viewer = "off";  ///< where the live page is served
};

/// Builds the scene, serves it until Ctrl-C, writes the report. Throws `Error`. Returns the exit code.
int run_server(const ServerOptions& options);

/// `sim_server run`.
Command run_command();

}  // namespace palpate::sim
