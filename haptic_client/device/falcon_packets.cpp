#include "haptic_client/device/falcon_packets.h"

#include <algorithm>

namespace palpate::client {
namespace {

constexpr std::byte kStart{'<'}, kEnd{'>'};
constexpr int kLetter = 'A';
constexpr std::size_t kNumbers = 3, kNibbles = 4,
                      kFlags = 1 + kNumbers * kNibbles;  // place of the byte of flags

std::byte letter(int value) {
  return static_cast<std::byte>(kLetter + value);
}
int value_of(std::byte b) {
  return std::to_integer<int>(b) - kLetter;
}

}  // namespace

std::array<std::byte, kFalconPacket> encode_falcon(const FalconCommand& command) noexcept {
  std::array<std::byte, kFalconPacket> packet{};
  packet.front() = kStart;
  packet.back() = kEnd;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const int torque = std::clamp<int>(command.torque[i], -kFalconMaxTorque, kFalconMaxTorque);
    const auto bits = static_cast<std::uint16_t>(torque);
    for (std::size_t n = 0; n < kNibbles; ++n) packet[1 + i * kNibbles + n] = letter(bits >> (4 * n) & 0xf);
  }
  packet[kFlags] = letter((command.homing ? 1 : 0) | (command.green ? 2 : 0) | (command.blue ? 4 : 0) |
                          (command.red ? 8 : 0));
  packet[kFlags + 1] = letter(0);
  return packet;
}

std::optional<FalconStatus> decode_falcon(std::span<const std::byte, kFalconPacket> packet) noexcept {
  if (packet.front() != kStart || packet.back() != kEnd) return {};
  FalconStatus status;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    unsigned bits = 0;
    for (std::size_t n = 0; n < kNibbles; ++n) {
      const int nibble = value_of(packet[1 + i * kNibbles + n]);
      if (nibble < 0 || nibble > 0xf) return {};
      bits |= static_cast<unsigned>(nibble) << (4 * n);
    }
    status.encoder[i] = static_cast<std::int16_t>(bits);
  }
  const int flags = value_of(packet[kFlags]);
  if (flags < 0 || flags > 0x7f) return {};
  status.buttons = static_cast<std::uint8_t>(flags & 0xf);
  status.homed = static_cast<std::uint8_t>(flags >> 4);
  return status;
}

std::size_t strip_ftdi_status(std::span<const std::byte> transfer, std::span<std::byte> out) noexcept {
  std::size_t size = 0;
  for (std::size_t at = 0; at < transfer.size(); at += kFtdiUsbPacket) {
    const auto packet = transfer.subspan(at, std::min(kFtdiUsbPacket, transfer.size() - at));
    for (std::size_t i = kFtdiStatus; i < packet.size(); ++i) out[size++] = packet[i];
  }
  return size;
}

std::optional<FalconStatus> FalconStream::push_byte(std::byte byte) noexcept {
  packet_[size_++] = byte;
  for (;;) {
    if (size_ == 0 || (packet_[0] == kStart && size_ < kFalconPacket)) return {};
    if (size_ == kFalconPacket) {
      if (const auto status = decode_falcon(packet_)) {
        size_ = 0;
        return status;
      }
    }
    // Not a packet from here: it may begin at the next `<` there is.
    const auto end = packet_.begin() + static_cast<std::ptrdiff_t>(size_);
    const auto next = std::find(packet_.begin() + 1, end, kStart);
    rubbish_ += static_cast<std::uint64_t>(next - packet_.begin());
    size_ = static_cast<std::size_t>(std::copy(next, end, packet_.begin()) - packet_.begin());
  }
}

}  // namespace palpate::client
