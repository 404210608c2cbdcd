#include "haptic_client/device/devices.h"

#include <array>
#include <set>

#include "common/clock.h"
#include "common/error.h"
#include "common/log.h"
#include "common/text.h"
#include "haptic_client/device/usb_port.h"

namespace palpate::client {
namespace {

const Vec3 kRest(0, 0.1, 0);  // m: above the organ of the scenes that ship

std::unique_ptr<Device> make_simulated(const DeviceSettings& settings) {
  Trajectory path = settings.trajectory ? Trajectory(*settings.trajectory) : Trajectory({0}, {kRest});
  if (settings.trajectory) path.log_source();
  return std::make_unique<SimulatedOperator>(settings.hand, std::move(path));
}

std::unique_ptr<Device> make_browser(const DeviceSettings& settings) {
  const Vec3 start = settings.trajectory ? Trajectory(*settings.trajectory).at(0) : kRest;
  return std::make_unique<Browser>(settings.hand, start);
}

DeviceLimits limits_of_simulated(const DeviceSettings& settings) {
  return {.max_force = settings.hand.max_force};
}

#ifdef PALPATE_WITH_USB
std::unique_ptr<UsbTransport> usb_port(const DeviceSettings& settings, const UsbKind& kind) {
  return std::make_unique<UsbPort>(kind, settings.port);
}
#else
std::unique_ptr<UsbTransport> usb_port(const DeviceSettings& settings, const UsbKind&) {
  fail("{}: device \"{}\" was left out of this build (PALPATE_USB=OFF); build with it, and libusb-1.0-0-dev",
       settings.where, settings.name);
}
#endif

std::unique_ptr<Device> make_falcon(const DeviceSettings& settings) {
  std::vector<std::byte> firmware;
  if (!settings.falcon.firmware.empty()) firmware = read_firmware(settings.falcon.firmware);
  return std::make_unique<Falcon>(usb_port(settings, {kFalconIds}), std::move(firmware),
                                  settings.falcon.torque_constant, settings.falcon.frozen_fade);
}

/// All that are there, if no port was asked for: which one the dead process had is not known, and the system
/// may not have taken it back yet.
int make_falcon_safe(const DeviceSettings& settings) {
#ifdef PALPATE_WITH_USB
  if (!settings.port.empty()) {
    UsbPorts port;
    port.push_back(usb_port(settings, {kFalconIds}));
    return silence_falcons(std::move(port)).falcons;
  }
  std::set<std::string> seen;
  int locked = 0;  // at the last look
  const Silenced silenced = silence_falcons({}, [&](UsbPorts& ports) {
    locked = 0;
    for (const UsbDevice& device : find_usb({kFalconIds})) {
      if (device.locked)
        ++locked;
      else if (seen.insert(device.path).second)
        ports.push_back(std::make_unique<UsbPort>(UsbKind{kFalconIds}, device.path));
    }
  });
  if (const int others = silenced.held + locked; silenced.falcons > 0 && others > 0)
    log::warning(
        "{} more Falcons could not be taken over, as another program holds them or they cannot be opened: if "
        "one pushes, switch it off",
        others);
  return silenced.falcons;
#else
  (void)settings;
  return 0;
#endif
}

DeviceLimits limits_of_falcon(const DeviceSettings&) {
  return {.max_force = 8, .min_period = std::chrono::milliseconds(1), .usual_rate_hz = 1000};
}

std::unique_ptr<Device> make_spacemouse(const DeviceSettings& settings) {
  return std::make_unique<SpaceMouse>(usb_port(settings, {spacemouse_ids(), true}), settings.spacemouse);
}

DeviceLimits limits_of_spacemouse(const DeviceSettings&) {
  return {};
}

std::vector<std::string> ports_of(const UsbKind& kind) {
#ifdef PALPATE_WITH_USB
  return find_usb_ports(kind);
#else
  (void)kind;
  return {};
#endif
}

constexpr std::array kDevices{
    DeviceRow{"simulated", "a hand (mass, spring, damper) that follows a recorded motion",
              &limits_of_simulated, &make_simulated, nullptr},
    DeviceRow{"browser", "the mouse in the page that `sim_server run SCENE --viewer 8080` serves",
              &limits_of_simulated, &make_browser, nullptr},
    DeviceRow{"falcon", "Novint Falcon over libusb; falcon:2-1 is the one at bus 2, port 1",
              &limits_of_falcon, &make_falcon, &make_falcon_safe, [] { return ports_of({kFalconIds}); }},
    DeviceRow{"spacemouse",
              "3Dconnexion 6-DoF mouse over libusb: moves the tool, gives no force; also spacemouse:PORT",
              &limits_of_spacemouse, &make_spacemouse, nullptr,
              [] {
                return ports_of({spacemouse_ids(), true});
              }},
};

}  // namespace

void choose_device(DeviceSettings& settings, const std::string& text, const std::string& where) {
  const std::size_t colon = text.find(':');
  settings.name = text.substr(0, colon);
  settings.port = colon == std::string::npos ? "" : text.substr(colon + 1);
  settings.where = where;
  row_of(settings);
}

std::span<const DeviceRow> devices() {
  return kDevices;
}

bool is_plugged_in(const DeviceSettings& settings) {
  const DeviceRow& row = row_of(settings);
  if (row.ports == nullptr) return true;
  const std::vector<std::string> ports = row.ports();
  return settings.port.empty() ? !ports.empty() : std::ranges::count(ports, settings.port) > 0;
}

std::string no_device_text(const DeviceSettings& settings) {
  return fmt::format(
      "{}: no {} came{}; `haptic_client devices` lists what is there, `--device simulated` is a hand without "
      "one, `scripts/run --emulate {}` emulates one",
      settings.where, settings.name, settings.port.empty() ? "" : " to port " + settings.port, settings.name);
}

const DeviceRow& row_of(const DeviceSettings& settings) {
  return find_row(devices(), settings.name, "device", settings.where);
}

}  // namespace palpate::client
