#include "haptic_client/device/devices.h"

#include <array>
#include <fmt/core.h>

#include "common/error.h"
#include "common/text.h"
#include "haptic_client/device/usb_port.h"

namespace palpate::client {
namespace {

const Vec3 kRest(0, 0.1, 0);  // m: above the organ of the scenes that ship

std::unique_ptr<Device> make_simulated(const DeviceSettings& settings) {
  Trajectory path = settings.trajectory ? Trajectory(*settings.trajectory) : Trajectory({0}, {kRest});
  return std::make_unique<SimulatedOperator>(settings.hand, std::move(path));
}

DeviceLimits limits_of_simulated(const DeviceSettings& settings) {
  return {.max_force = settings.hand.max_force};
}

std::unique_ptr<Device> make_falcon(const DeviceSettings& settings) {
#ifdef PALPATE_WITH_USB
  std::vector<std::byte> firmware;
  if (!settings.falcon.firmware.empty()) firmware = read_firmware(settings.falcon.firmware);
  return std::make_unique<Falcon>(std::make_unique<UsbPort>(UsbKind{kFalconIds}, settings.port),
                                  std::move(firmware), settings.falcon.torque_constant);
#else
  fail(
      "{}: device \"falcon\" was left out of this build (PALPATE_USB=OFF); build with it, and "
      "libusb-1.0-0-dev",
      settings.where);
#endif
}

DeviceLimits limits_of_falcon(const DeviceSettings&) {
  return {.max_force = 8, .min_period = std::chrono::milliseconds(1)};
}

constexpr std::array kDevices{
    DeviceRow{"simulated", "a hand (mass, spring, damper) that follows a recorded motion",
              &limits_of_simulated, &make_simulated},
    DeviceRow{"falcon", "Novint Falcon over libusb; falcon:2-1 is the one at bus 2, port 1",
              &limits_of_falcon, &make_falcon},
};

}  // namespace

void choose_device(DeviceSettings& settings, const std::string& text, const std::string& where) {
  const std::size_t colon = text.find(':');
  settings.name = text.substr(0, colon);
  settings.port = colon == std::string::npos ? "" : text.substr(colon + 1);
  settings.where = where;
  find_row(devices(), settings.name, "device", where);
}

std::span<const DeviceRow> devices() {
  return kDevices;
}

int print_plugged_in() {
#ifdef PALPATE_WITH_USB
  const std::vector<UsbDevice> found = find_usb(kFalconIds);
  if (found.empty())
    fmt::print("no device that Palpate knows is plugged in; known: Novint Falcon ({:04x}:{:04x})\n",
               kFalconIds[0].vendor, kFalconIds[0].product);
  bool locked = false;
  for (const UsbDevice& device : found) {
    fmt::print("{:10} Novint Falcon    --device falcon:{}    {}\n", device.path, device.path,
               device.access.empty() ? "ready to use" : device.access);
    locked = locked || device.locked;
  }
  if (locked) {
    fmt::print(
        "this rule in /etc/udev/rules.d/70-palpate.rules gives access (scripts/setup --udev puts it there); "
        "then "
        "plug the device in again:\n"
        "SUBSYSTEM==\"usb\", ATTR{{idVendor}}==\"{:04x}\", ATTR{{idProduct}}==\"{:04x}\", MODE=\"0660\", "
        "GROUP=\"plugdev\", TAG+=\"uaccess\"\n",
        kFalconIds[0].vendor, kFalconIds[0].product);
  }
  return 0;
#else
  fail("USB devices were left out of this build (PALPATE_USB=OFF); build with it, and libusb-1.0-0-dev");
#endif
}

}  // namespace palpate::client
