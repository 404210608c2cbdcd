#pragma once
#include <memory>
#include <string>
#include <vector>

#include "haptic_client/device/usb_transport.h"

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

/// An interface of a device through libusb, asynchronously (the only file that knows libusb): four IN
/// transfers of a packet each are always pending, OUT and control transfers go without waiting, unplugging is
/// NO_DEVICE. `open` takes a few us while nothing was plugged in, some milliseconds when it opens; nothing
/// else waits. The kernel's driver gives way while it is open.
class UsbPort : public UsbTransport {
 public:
  /// `path`: as in `UsbDevice`; empty: the first there is that nobody holds. Throws `Error` when there is no
  /// USB at all.
  UsbPort(UsbKind kind, std::string path);
  ~UsbPort() override;
  bool open(Time now) noexcept override;
  void close() noexcept override;
  void control(const UsbRequest& request) noexcept override;
  bool write(std::span<const std::byte> bytes) noexcept override;
  std::size_t read(std::span<std::byte> out) noexcept override;
  State state() const noexcept override;
  const char* trouble() const noexcept override;
  /// Where the device is that `open` got, as in `UsbDevice`; empty while it is closed. The haptic thread.
  const char* path() const noexcept;

 private:
  struct Libusb;
  std::unique_ptr<Libusb> usb_;
};

}  // namespace palpate::client
