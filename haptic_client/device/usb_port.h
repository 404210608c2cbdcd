#pragma once
#include <memory>
#include <string>

#include "haptic_client/device/usb_bus.h"
#include "haptic_client/device/usb_transport.h"

namespace palpate::client {

/// An interface of a device through libusb, asynchronously: four IN
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
  /// Returns the path of the device that `open` claimed, as in `UsbDevice`; empty while it is closed. Haptic
  /// thread.
  const char* path() const noexcept;

 private:
  struct Libusb;
  std::unique_ptr<Libusb> usb_;
};

}  // namespace palpate::client
