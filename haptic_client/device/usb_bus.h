#pragma once
/// The USB devices that are plugged in, through libusb, whose types stay out of this header.
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "haptic_client/device/usb_transport.h"

struct libusb_context;
struct libusb_device;

namespace palpate::client {

/// The devices that a driver takes, and which of their interfaces.
struct UsbKind {
  std::span<const UsbId> ids;  ///< lives as long as the program
  /// true: the first HID interface with an interrupt IN endpoint; false: the first with any bulk or interrupt
  /// one.
  bool hid = false;
};

/// A device on the bus that we know.
struct UsbDevice {
  std::string path;  ///< "2-1": bus and ports, as in lsusb -t
  UsbId id;
  std::string access;   ///< empty: it can be used; else why not
  bool locked = false;  ///< why not: no permission
};

/// Devices of this kind that are plugged in now, in the order of their paths. Opens and closes each one, and
/// takes its interface for a moment unless the kernel's driver has it, to see whether a program does. Throws
/// `Error` when there is no USB at all.
std::vector<UsbDevice> find_usb(const UsbKind& kind);
/// Their paths alone: opens nothing.
std::vector<std::string> find_usb_ports(const UsbKind& kind);

/// "2-1.4", zero at the end.
using UsbPath = std::array<char, 32>;
UsbPath path_of(libusb_device* device);

/// A session of libusb, to be ended with `libusb_exit`. Throws `Error` when there is no USB at all.
libusb_context* start_usb();

/// Returns what libusb's error means to the person at the device; empty for a device that was unplugged.
const char* in_words(int error);

/// Calls `use` for each device of these kinds, in the order of their paths. Nothing is opened.
void for_each_usb(libusb_context* context, std::span<const UsbId> ids,
                  const std::function<void(libusb_device*, const UsbId&)>& use);

/// Endpoint of a USB transfer.
struct UsbEndpoint {
  std::uint8_t address = 0;  ///< 0: there is none
  std::uint8_t type = 0;     ///< libusb_endpoint_transfer_type
  std::size_t size = 0;      ///< bytes of its largest packet
};

/// An interface of a device, and its endpoints.
struct UsbInterface {
  int number = 0;
  UsbEndpoint in, out;
};

/// Largest packet that is read, bytes.
constexpr std::size_t kMostUsbIn = 512;

/// The interface that `UsbKind::hid` asks for, if the device has it.
std::optional<UsbInterface> choose_interface(libusb_device* device, bool hid);

}  // namespace palpate::client
