#include "haptic_client/device/usb_bus.h"

#include <algorithm>
#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include "common/error.h"

namespace palpate::client {
namespace {

/// The first endpoint of a direction that carries bulk or interrupt transfers.
UsbEndpoint first_endpoint(const libusb_interface_descriptor& setting, std::uint8_t direction,
                           bool bulk_too) {
  for (int i = 0; i < setting.bNumEndpoints; ++i) {
    const auto& e = setting.endpoint[i];
    const auto type = static_cast<std::uint8_t>(e.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK);
    const std::size_t size = e.wMaxPacketSize & 0x7ffu;
    const bool fits =
        type == LIBUSB_TRANSFER_TYPE_INTERRUPT || (bulk_too && type == LIBUSB_TRANSFER_TYPE_BULK);
    if ((e.bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == direction && fits && size > 0)
      return {e.bEndpointAddress, type, size};
  }
  return {};
}

}  // namespace

UsbPath path_of(libusb_device* device) {
  std::array<std::uint8_t, 7> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  UsbPath path{};
  const auto last = path.end() - 1;
  auto at = fmt::format_to_n(path.begin(), last - path.begin(), "{}", libusb_get_bus_number(device)).out;
  for (int i = 0; i < count; ++i)
    at = fmt::format_to_n(at, last - at, "{}{}", i == 0 ? '-' : '.', ports[static_cast<std::size_t>(i)]).out;
  return path;
}

const char* in_words(int error) {
  switch (error) {
    case LIBUSB_ERROR_ACCESS:
      return "no permission for the USB device; `haptic_client devices` prints the udev rule that gives it";
    case LIBUSB_ERROR_BUSY:
      return "another program holds the USB device; end it";
    case LIBUSB_ERROR_NO_DEVICE:
      return "";
    default:
      return "the USB device cannot be opened; unplug it and plug it in again";
  }
}

void for_each_usb(libusb_context* context, std::span<const UsbId> ids,
                  const std::function<void(libusb_device*, const UsbId&)>& use) {
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context, &list);
  if (count > 0) std::sort(list, list + count, [](auto* a, auto* b) { return path_of(a) < path_of(b); });
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
    const UsbId id{descriptor.idVendor, descriptor.idProduct};
    if (std::ranges::find(ids, id) != ids.end()) use(list[i], id);
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
}

libusb_context* start_usb() {
  libusb_context* context = nullptr;
  if (const int error = libusb_init(&context); error != 0)
    fail_at_run_time("USB cannot be used ({})", libusb_strerror(static_cast<libusb_error>(error)));
  return context;
}

std::optional<UsbInterface> choose_interface(libusb_device* device, bool hid) {
  libusb_config_descriptor* config = nullptr;
  if (libusb_get_active_config_descriptor(device, &config) != 0) return {};
  std::optional<UsbInterface> chosen;
  for (int i = 0; i < config->bNumInterfaces && !chosen; ++i) {
    if (config->interface[i].num_altsetting < 1) continue;
    const auto& setting = config->interface[i].altsetting[0];
    if (hid && setting.bInterfaceClass != LIBUSB_CLASS_HID) continue;
    const UsbEndpoint in = first_endpoint(setting, LIBUSB_ENDPOINT_IN, !hid);
    if (in.address == 0 || in.size > kMostUsbIn) continue;
    chosen = {setting.bInterfaceNumber, in, first_endpoint(setting, LIBUSB_ENDPOINT_OUT, true)};
  }
  libusb_free_config_descriptor(config);
  return chosen;
}

namespace {

/// Returns 0 if a program could use it now, or libusb's error. The kernel's driver would yield, and is not
/// touched here.
int try_to_use(libusb_device* device, bool hid) {
  libusb_device_handle* handle = nullptr;
  int error = libusb_open(device, &handle);
  if (error != 0) return error;
  const auto interface = choose_interface(device, hid);
  if (interface && libusb_kernel_driver_active(handle, interface->number) != 1) {
    error = libusb_claim_interface(handle, interface->number);
    if (error == 0) libusb_release_interface(handle, interface->number);
  }
  libusb_close(handle);
  return error;
}

}  // namespace

std::vector<UsbDevice> find_usb(const UsbKind& kind) {
  libusb_context* context = start_usb();
  std::vector<UsbDevice> found;
  for_each_usb(context, kind.ids, [&](libusb_device* device, const UsbId& id) {
    const int error = try_to_use(device, kind.hid);
    found.push_back(
        {path_of(device).data(), id, error == 0 ? "" : in_words(error), error == LIBUSB_ERROR_ACCESS});
  });
  libusb_exit(context);
  return found;
}

std::vector<std::string> find_usb_ports(const UsbKind& kind) {
  libusb_context* context = start_usb();
  std::vector<std::string> ports;
  for_each_usb(context, kind.ids,
               [&](libusb_device* device, const UsbId&) { ports.emplace_back(path_of(device).data()); });
  libusb_exit(context);
  return ports;
}

}  // namespace palpate::client
