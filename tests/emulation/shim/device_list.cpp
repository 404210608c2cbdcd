#include "tests/emulation/shim/device_list.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <unistd.h>

#include "tests/emulation/shim/real.h"

namespace palpate::emulation {

const std::string& emulator_socket() {
  static const std::string& path = *new std::string([] {
    const char* text = std::getenv("USBSHIM");
    return text == nullptr ? "" : text;
  }());
  return path;
}

std::string DeviceEntry::node() const {
  char text[32];
  std::snprintf(text, sizeof text, "/dev/bus/usb/%03d/%03d", bus, address);
  return text;
}

DeviceEntry device_entry(const wire::Frame& frame) {
  const auto end = std::ranges::find(frame.payload, 0);
  DeviceEntry entry{{frame.payload.begin(), end}, frame.header.bus, frame.header.address, {}};
  if (end != frame.payload.end()) entry.descriptors.assign(end + 1, frame.payload.end());
  return entry;
}

std::vector<DeviceEntry> list_devices() {
  std::vector<DeviceEntry> devices;
  const int fd = wire::connect_to(emulator_socket());
  if (fd < 0) {
    std::fprintf(stderr, "libusb_vhci_shim: nobody serves %s\n", emulator_socket().c_str());
    return devices;
  }
  wire::Frame ask;
  ask.header.kind = wire::Kind::kList;
  wire::FrameReader reader;
  bool more = wire::send(fd, ask);
  while (more && reader.fill(fd, true)) {
    while (const auto frame = reader.next()) {
      more = frame->header.kind == wire::Kind::kDevice;
      if (more) devices.push_back(device_entry(*frame));
    }
  }
  close(fd);
  return devices;
}

std::optional<std::string> sysfs_attribute(const std::string& name, const std::string& attribute) {
  const auto devices = list_devices();
  const auto device = std::ranges::find_if(devices, [&](const DeviceEntry& d) { return d.name == name; });
  if (device == devices.end()) return std::nullopt;
  if (attribute == "busnum") return std::to_string(device->bus) + "\n";
  if (attribute == "devnum") return std::to_string(device->address) + "\n";
  if (attribute == "speed") return "12\n";
  if (attribute == "bConfigurationValue") return "1\n";
  if (attribute == "descriptors") return std::string(device->descriptors.begin(), device->descriptors.end());
  return std::nullopt;
}

}  // namespace palpate::emulation
