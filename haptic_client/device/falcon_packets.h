#pragma once
/// Packets between host and Novint Falcon: 16 bytes each way, nibbles as letters, behind an FTDI UART bridge.
/// Byte layout: libnifalcon's firmware interface.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "haptic_client/device/usb_transport.h"

namespace palpate::client {

constexpr std::size_t kFalconPacket = 16;                 ///< bytes, `<` to `>`
constexpr std::size_t kFtdiUsbPacket = kFullSpeedPacket;  ///< begins with two status bytes
constexpr std::size_t kFtdiStatus = 2;                    ///< bytes
constexpr int kFalconMaxTorque = 4096;                    ///< of a motor command, DAC units

/// Host to device.
struct FalconCommand {
  std::array<std::int16_t, 3> torque{};  ///< top, right, left motor, DAC units, +-4096
  bool homing = true;                    ///< must be set in every packet, or the device forgets its home
  bool green = false, blue = false, red = false;
};

/// Device to host.
struct FalconStatus {
  std::array<std::int16_t, 3> encoder{};  ///< top, right, left, counts
  std::uint8_t buttons = 0;               ///< bit 0 plus, 1 forward, 2 centre, 3 minus
  std::uint8_t homed = 0;                 ///< bit 0 top, 1 right, 2 left; valid while homing is on
  bool all_homed() const { return homed == 7; }
};

/// The 16 bytes of a command; torques beyond +-4096 are cut.
std::array<std::byte, kFalconPacket> encode_falcon(const FalconCommand& command) noexcept;

/// The status in 16 bytes `<`..`>`, or nothing if a byte is none of a packet's.
std::optional<FalconStatus> decode_falcon(std::span<const std::byte, kFalconPacket> packet) noexcept;

/// Copies the payload of an IN transfer (64-byte packets, each with two status bytes in front) to `out` and
/// returns its size. `out` must hold `transfer.size()` bytes.
std::size_t strip_ftdi_status(std::span<const std::byte> transfer, std::span<std::byte> out) noexcept;

/// Finds packets in a stream of bytes that may begin anywhere, be cut anywhere and hold rubbish: `<` and `>`
/// at a distance of 15. No allocation; a few ns a byte.
class FalconStream {
 public:
  /// Takes bytes; calls `use(const FalconStatus&)` for each packet that is whole with them.
  template <class Use>
  void push(std::span<const std::byte> bytes, Use use) noexcept {
    for (const std::byte byte : bytes) {
      if (const auto status = push_byte(byte)) use(*status);
    }
  }
  void clear() noexcept { size_ = 0; }
  /// Bytes that were part of no packet.
  std::uint64_t rubbish() const noexcept { return rubbish_; }

 private:
  std::optional<FalconStatus> push_byte(std::byte byte) noexcept;

  std::array<std::byte, kFalconPacket> packet_{};
  std::size_t size_ = 0;
  std::uint64_t rubbish_ = 0;
};

}  // namespace palpate::client
