#pragma once
#include <filesystem>
#include <string>

#include "haptic_client/device/devices.h"
#include "haptic_client/loop/workspace.h"
#include "haptic_client/safety/limiter.h"

namespace palpate::client {

/// What a client file asks for; every key has a default.
struct ClientConfig {
  std::string server = "127.0.0.1:45130", server_where = "default";
  double rate_hz = 500;                    ///< haptic ticks per second, [100, 4000]
  std::string method = "linear_position";  ///< a name of `extrapolators()`
  std::string method_where = "default";
  DeviceSettings device;
  Workspace workspace;
  Limiter::Settings limits;
};

constexpr double kMinRate = 100, kMaxRate = 4000;  // Hz

/// Reads and checks a client file. Throws `Error`. Does not open the trajectory or the device.
ClientConfig read_client_config(const std::filesystem::path& file);

}  // namespace palpate::client
