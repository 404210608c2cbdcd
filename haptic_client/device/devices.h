#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "haptic_client/device/device.h"
#include "haptic_client/device/simulated_operator.h"

namespace palpate::client {

/// Everything a device may want to know from the client's configuration.
struct DeviceSettings {
  std::string name = "simulated";
  std::string where = "default";
  OperatorSettings hand;
  std::optional<TrajectorySettings> trajectory;  ///< absent: the simulated hand holds still at (0, 0.1, 0)
};

/// One row per device: a new one is one file and one row.
struct DeviceRow {
  std::string_view name;
  std::string_view summary;
  DeviceLimits (*limits)(const DeviceSettings&);
  std::unique_ptr<Device> (*make)(const DeviceSettings&);
};
std::span<const DeviceRow> devices();

}  // namespace palpate::client
