#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate::client {

/// A UART bridge on a USB bus, as a driver needs it: nothing waits. One thread (the haptic one).
class UsbTransport {
 public:
  virtual ~UsbTransport() = default;
  /// Looks for the device and claims it; false when there is none, or it may not be used (`trouble` says
  /// why).
  virtual bool open() noexcept = 0;
  virtual void close() noexcept = 0;
  /// A vendor request without data to the device, after those before it.
  virtual void control(std::uint8_t request, std::uint16_t value) noexcept = 0;
  /// Bulk bytes to the device, at most 64; false when too many are on the way.
  virtual bool write(std::span<const std::byte> bytes) noexcept = 0;
  /// What came, without the bridge's status bytes; at most `out.size()` bytes a call.
  virtual std::size_t read(std::span<std::byte> out) noexcept = 0;

  /// How a transport is.
  enum class State : std::uint8_t { kClosed, kIdle, kBusy, kLost };
  /// kBusy: requests or bytes are on the way; kLost: unplugged, or a transfer failed.
  virtual State state() const noexcept = 0;
  /// Why `open` failed last, a static text; empty when there was simply no device.
  virtual const char* trouble() const noexcept = 0;
};

}  // namespace palpate::client
