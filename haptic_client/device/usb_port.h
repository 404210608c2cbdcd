#pragma once
#include <memory>
#include <string>
#include <vector>

#include "haptic_client/device/usb_transport.h"

namespace palpate::client {

/// A device on the bus that we know.
struct UsbDevice {
  std::string path;  ///< "2-1": bus and ports, as in lsusb -t
  std::uint16_t vendor = 0, product = 0;
  std::string access;  ///< empty: it can be opened; else why not
};

/// Devices plugged in now with this vendor and product number, in the order of their paths. Opens and closes
/// each one. Throws `Error` when there is no USB at all.
std::vector<UsbDevice> find_usb(std::uint16_t vendor, std::uint16_t product);

/// An FTDI bridge through libusb, asynchronously (the only file that knows libusb): two IN transfers are
/// always pending, OUT and control transfers go without waiting, unplugging is NO_DEVICE. `open` may take
/// some milliseconds; nothing else waits.
class UsbPort : public UsbTransport {
 public:
  /// `path`: as in `UsbDevice`; empty: the first there is. Throws `Error` when there is no USB at all.
  UsbPort(std::uint16_t vendor, std::uint16_t product, std::string path);
  ~UsbPort() override;
  bool open() noexcept override;
  void close() noexcept override;
  void control(std::uint8_t request, std::uint16_t value) noexcept override;
  bool write(std::span<const std::byte> bytes) noexcept override;
  std::size_t read(std::span<std::byte> out) noexcept override;
  State state() const noexcept override;
  const char* trouble() const noexcept override;

 private:
  struct Libusb;
  std::unique_ptr<Libusb> usb_;
};

}  // namespace palpate::client
