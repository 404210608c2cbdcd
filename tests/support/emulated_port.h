#pragma once
/// An emulated device on a transport in memory: driver and pipeline in virtual time, without libusb.
#include <algorithm>

#include "haptic_client/device/usb_transport.h"
#include "tests/emulation/usb_device.h"

namespace palpate::test {

/// A device that is always plugged in and answers at once.
class EmulatedPort : public client::UsbTransport {
 public:
  explicit EmulatedPort(emulation::UsbDevice& device) : device_(device) {}

  bool open(Time now) noexcept override {
    now_ = to_seconds(now);
    open_ = true;
    device_.opened(now_);
    return true;
  }
  void close() noexcept override { open_ = false; }
  void control(const client::UsbRequest& request) noexcept override {
    device_.control({request.type, request.request, request.value, request.index,
                     static_cast<std::uint16_t>(request.data.size())},
                    bytes(request.data), now_);
  }
  bool write(std::span<const std::byte> out) noexcept override {
    return device_.write(kOut, bytes(out), now_) == 0;
  }
  std::size_t read(std::span<std::byte> out) noexcept override {
    const auto in = device_.read(kIn, kPacket, now_);
    if (!in || in->status != 0) return 0;
    const std::size_t size = std::min(out.size(), in->data.size());
    std::transform(in->data.begin(), in->data.begin() + static_cast<std::ptrdiff_t>(size), out.begin(),
                   [](std::uint8_t byte) { return std::byte{byte}; });
    return size;
  }
  State state() const noexcept override { return open_ ? State::kIdle : State::kClosed; }
  const char* trouble() const noexcept override { return ""; }

  /// The time of what follows.
  void advance(Time now) { now_ = to_seconds(now); }

 private:
  static constexpr std::uint8_t kIn = 0x81, kOut = 0x02;
  static constexpr std::size_t kPacket = 64;
  static emulation::Bytes bytes(std::span<const std::byte> from) {
    emulation::Bytes to;
    for (const std::byte byte : from) to.push_back(std::to_integer<std::uint8_t>(byte));
    return to;
  }

  emulation::UsbDevice& device_;
  bool open_ = false;
  double now_ = 0;  // s
};

}  // namespace palpate::test
