#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/time.h"

namespace palpate::client {

/// Vendor and product number of a kind of device.
struct UsbId {
  std::uint16_t vendor = 0, product = 0;
  bool operator==(const UsbId&) const = default;
};

/// Largest packet of a full-speed device, bytes.
constexpr std::size_t kFullSpeedPacket = 64;

/// A control request to a device: the four numbers of its set-up packet, and its data.
struct UsbRequest {
  std::uint8_t type = 0;     ///< bmRequestType, host to device: 0x40 vendor, 0x21 class and interface
  std::uint8_t request = 0;  ///< bRequest
  std::uint16_t value = 0;   ///< wValue
  std::uint16_t index = 0;   ///< wIndex; of a request to the interface: the one that was claimed goes there
  bool optional = false;     ///< a device that refuses it can still be used
  std::span<const std::byte> data = {};  ///< at most 64 bytes
};

/// Interface of a device on a USB bus, as a driver needs it: no call waits. One thread (the haptic one).
class UsbTransport {
 public:
  virtual ~UsbTransport() = default;
  /// Claims the device; false when there is none, or it may not be used (`trouble` says why). Call it every
  /// tick: it looks for the device only when that can be of use.
  virtual bool open(Time now) noexcept = 0;
  virtual void close() noexcept = 0;
  /// A request to the device, after those before it.
  virtual void control(const UsbRequest& request) noexcept = 0;
  /// Bytes to the OUT endpoint, at most 64; false when there is none, or too many are on the way.
  virtual bool write(std::span<const std::byte> bytes) noexcept = 0;
  /// Reads one packet of the IN endpoint as it came from the wire, in order; returns its size, 0: no packet.
  /// Bytes beyond `out.size()` are lost (no device has more than 512).
  virtual std::size_t read(std::span<std::byte> out) noexcept = 0;

  /// State of a transport.
  enum class State : std::uint8_t { kClosed, kIdle, kBusy, kLost };
  /// kBusy: requests or bytes are on the way; kLost: unplugged, or a transfer failed.
  virtual State state() const noexcept = 0;
  /// Why `open` failed last, or why it is lost, a static text; empty when there is simply no device (any
  /// more).
  virtual const char* trouble() const noexcept = 0;
};

}  // namespace palpate::client
