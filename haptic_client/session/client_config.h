#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/workspace.h"
#include "haptic_client/device/devices.h"
#include "haptic_client/safety/limiter.h"
#include "haptic_client/safety/passivity.h"

namespace palpate::client {

/// Settings of a client file; every key has a default.
struct ClientConfig {
  std::string server = "127.0.0.1:45130", server_where = "default";
  std::optional<std::filesystem::path> key;  ///< file of the key that the server has, too
  bool insecure = false;                     ///< leave this machine without one
  double rate_hz = 500;                      ///< haptic ticks per second, [100, 4000]
  std::string method = "best_recent";        ///< a name of `extrapolators()`
  std::string method_where = "default";
  /// Laws that run beside it and are scored, and the chosen one with them; absent: the paper's three and
  /// that; empty: none.
  std::optional<std::vector<std::string>> score;
  std::string score_where = "default";
  double blend = 0.01;  ///< s, [0, 0.1]: time constant of what a new sample changes, of all laws; 0: at once
  DeviceSettings device;
  Workspace workspace;
  Limiter::Settings limits;
  Passivity::Settings passivity;

  /// The laws to score, each once.
  std::vector<std::string> scored_laws() const;
  /// Returns the settings of the limiter: as configured, or the limit of the device if that is less.
  Limiter::Settings device_limits() const;
};

constexpr double kMinRate = 100, kMaxRate = 4000;  // Hz

/// Reads and checks a client file. Throws `Error`. Does not open the trajectory or the device.
ClientConfig read_client_config(const std::filesystem::path& file);

}  // namespace palpate::client
