#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/emulation/wire.h"

namespace palpate::emulation {

/// What the emulator says of a device.
struct DeviceEntry {
  std::string name;  // as in sysfs
  int bus = 0, address = 0;
  wire::Bytes descriptors;
  std::string node() const;  // below /dev/bus/usb
};

/// From a kDevice, kAttached or kDetached.
DeviceEntry device_entry(const wire::Frame& frame);
/// All that are plugged in. Empty if no emulator answers.
std::vector<DeviceEntry> list_devices();
/// A file of sysfs: what stands in `attribute` of the device `name`; none: there is no such file.
std::optional<std::string> sysfs_attribute(const std::string& name, const std::string& attribute);

}  // namespace palpate::emulation
