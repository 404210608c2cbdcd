#pragma once
/// What the parts of usb_smoke share: libusb with errors as exceptions.
#include <cstdint>
#include <cstdio>
#include <libusb-1.0/libusb.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::usb_smoke {

using Bytes = std::vector<std::uint8_t>;
constexpr unsigned kTimeout = 1000;  // ms
constexpr std::uint8_t kIn = 0x81, kOut = 0x02;

inline int checked(int result, const char* what) {
  if (result < 0) throw std::runtime_error(std::string(what) + " " + libusb_error_name(result));
  return result;
}

struct Context {
  libusb_context* usb = nullptr;
  Context() { checked(libusb_init(&usb), "init"); }
  ~Context() { libusb_exit(usb); }
};

struct Handle {
  libusb_device_handle* usb = nullptr;
  Handle(const Context& context, std::uint16_t vendor, std::uint16_t product) {
    libusb_device** all = nullptr;
    const auto count = libusb_get_device_list(context.usb, &all);
    int result = LIBUSB_ERROR_NOT_FOUND;
    for (ssize_t i = 0; i < count && usb == nullptr; ++i) {
      libusb_device_descriptor d{};
      libusb_get_device_descriptor(all[i], &d);
      if (d.idVendor == vendor && d.idProduct == product) result = libusb_open(all[i], &usb);
    }
    libusb_free_device_list(all, 1);
    checked(usb == nullptr ? result : 0, "open");
    libusb_set_auto_detach_kernel_driver(usb, 1);
  }
  ~Handle() { libusb_close(usb); }
  void claim() const { checked(libusb_claim_interface(usb, 0), "claim"); }
};

/// A request of the FTDI chip.
inline void ftdi(const Handle& device, std::uint8_t request, std::uint16_t value) {
  checked(libusb_control_transfer(device.usb, 0x40, request, value, 0, nullptr, 0, kTimeout), "control");
}

/// Opens the Falcon, waits for its unplugging with a transfer under way, and for its return.
void hotplug(const Context& context);
/// Two transfers that time out, and with them are cancelled.
void timeouts(const Context& context);
/// Keeps 64 transfers under way, more than libusb reaps at once, until `count` have ended; then cancels the
/// rest.
void storm(const Context& context, int count);

}  // namespace palpate::usb_smoke
