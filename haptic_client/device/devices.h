#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "haptic_client/device/browser.h"
#include "haptic_client/device/device.h"
#include "haptic_client/device/falcon.h"
#include "haptic_client/device/simulated_operator.h"
#include "haptic_client/device/spacemouse.h"

namespace palpate::client {

/// Everything a device may want to know from the client's configuration.
struct DeviceSettings {
  std::string name = "simulated";
  std::string where = "default";
  std::string port;  ///< "2-1": bus and ports; empty: the first there is
  FalconSettings falcon;
  SpaceMouseSettings spacemouse;
  OperatorSettings hand;
  std::optional<TrajectorySettings> trajectory;  ///< absent: the simulated hand holds still at (0, 0.1, 0)
};

/// Takes "NAME" or "NAME:PORT". Throws `Error` for a name that is none.
void choose_device(DeviceSettings& settings, const std::string& text, const std::string& where);

/// Row of a device: a new device is one file and one row.
struct DeviceRow {
  std::string_view name;
  std::string_view summary;
  DeviceLimits (*limits)(const DeviceSettings&);
  std::unique_ptr<Device> (*make)(const DeviceSettings&);
  /// Takes the device over from a process that died, and sends it zero force; returns how many there were.
  /// May take a second. Throws `Error`. Null: it has no motors, or they end with the process.
  int (*make_safe)(const DeviceSettings&);
  /// The ports at which there are such devices now. Null: it has no port.
  std::vector<std::string> (*ports)() = nullptr;
};
std::span<const DeviceRow> devices();
/// True if such a device is plugged in now, at its port where it names one; always true for devices without a
/// port.
bool is_plugged_in(const DeviceSettings& settings);
/// "FILE:LINE: no falcon came; ...", with what can be done instead.
std::string no_device_text(const DeviceSettings& settings);
/// The row of the device that is asked for. Throws `Error` for a name that is none.
const DeviceRow& row_of(const DeviceSettings& settings);

}  // namespace palpate::client
