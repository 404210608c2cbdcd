#include "haptic_client/commands/devices.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "common/error.h"
#include "haptic_client/device/devices.h"
#include "haptic_client/device/usb_bus.h"

namespace palpate::client {
namespace {

#ifdef PALPATE_WITH_USB
bool is_falcon(const UsbId& id) {
  return std::ranges::find(kFalconIds, id) != kFalconIds.end();
}

/// One for all products of this vendor that we know, as in configs/udev/70-palpate.rules.
std::string udev_rule(std::uint16_t vendor, std::span<const UsbId> known) {
  std::string products;
  for (const UsbId& id : known) {
    if (id.vendor == vendor) products += fmt::format("{}{:04x}", products.empty() ? "" : "|", id.product);
  }
  return fmt::format(
      "SUBSYSTEM==\"usb\", ATTR{{idVendor}}==\"{:04x}\", ATTR{{idProduct}}==\"{}\", MODE=\"0660\", "
      "GROUP=\"plugdev\", TAG+=\"uaccess\"",
      vendor, products);
}
#endif

}  // namespace

int print_plugged_in() {
#ifdef PALPATE_WITH_USB
  std::vector<UsbId> known(kFalconIds.begin(), kFalconIds.end());
  known.insert(known.end(), spacemouse_ids().begin(), spacemouse_ids().end());
  std::vector<UsbDevice> found = find_usb({kFalconIds});
  for (UsbDevice& mouse : find_usb({spacemouse_ids(), true})) found.push_back(std::move(mouse));
  if (found.empty()) {
    fmt::print("no device that Palpate knows is plugged in; known: Novint Falcon, 3Dconnexion 6-DoF mice\n");
    return 1;
  }
  std::set<std::string> rules;
  for (const UsbDevice& device : found) {
    const bool falcon = is_falcon(device.id);
    const char* const model = falcon ? "Novint Falcon" : spacemouse_name(device.id);
    fmt::print("{:10} {:30} --device {}:{}    {}\n", device.path, model, falcon ? "falcon" : "spacemouse",
               device.path, device.access.empty() ? "ready to use" : device.access);
    if (device.locked) rules.insert(udev_rule(device.id.vendor, known));
  }
  if (!rules.empty()) {
    fmt::print(
        "what follows, in /etc/udev/rules.d/70-palpate.rules, gives access (scripts/setup --udev puts it "
        "there); then plug the device in again:\n{}\n",
        fmt::join(rules, "\n"));
  }
  return 0;
#else
  fail("USB devices were left out of this build (PALPATE_USB=OFF); build with it, and libusb-1.0-0-dev");
#endif
}

Command devices_command() {
  return {.name = "devices",
          .summary = "List the devices that are plugged in, and whether they can be used",
          .footer = "Example: haptic_client devices",
          .run = print_plugged_in};
}

}  // namespace palpate::client
