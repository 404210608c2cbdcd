#pragma once
#include <filesystem>
#include <optional>

#include "haptic_client/session/client_config.h"

namespace palpate::client {

/// What `haptic_client replay` was asked for, beyond the configuration (whose method, workspace, limits and
/// laws to score count here; its server and device do not).
struct ReplayOptions {
  std::filesystem::path capture;
  std::optional<double> rate_hz;  ///< ticks a second; absent, or within 2 % of the capture's: its own ticks
  std::optional<int> session;     ///< from 1, as listed; absent: the longest
  std::optional<std::filesystem::path> out;     ///< CSV, a row a tick
  std::optional<std::filesystem::path> report;  ///< JSON
};

/// Runs the ticks of a captured session through law, watchdog and limiter again, offline: the same forces,
/// bit by bit, whenever it is done. Throws `Error`. Returns the exit code.
int replay(const ClientConfig& config, const ReplayOptions& options);

}  // namespace palpate::client
