#include "tests/emulation/falcon_packet.h"

namespace palpate::emulation {
namespace {

constexpr std::uint8_t kInitialize = '<', kEnd = '>', kZero = 'A';

std::optional<FalconPacket> decode(const std::deque<std::uint8_t>& bytes) {
  if (bytes[15] != kEnd || bytes[13] < kZero || bytes[14] < kZero) return std::nullopt;
  FalconPacket packet;
  for (std::size_t i = 0; i < 12; ++i) {
    const int nibble = bytes[1 + i] - kZero;
    if (nibble < 0 || nibble > 15) return std::nullopt;
    auto& number = packet.numbers[i / 4];
    number = static_cast<std::int16_t>(static_cast<std::uint16_t>(number) | (nibble << (4 * (i % 4))));
  }
  packet.flags = static_cast<std::uint8_t>(bytes[13] - kZero);
  packet.more = static_cast<std::uint8_t>(bytes[14] - kZero);
  return packet;
}

}  // namespace

Bytes encode(const FalconPacket& packet) {
  Bytes bytes{kInitialize};
  for (const std::int16_t number : packet.numbers) {
    const auto bits = static_cast<std::uint16_t>(number);
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(kZero + ((bits >> (4 * i)) & 15)));
  }
  bytes.push_back(static_cast<std::uint8_t>(kZero + packet.flags));
  bytes.push_back(static_cast<std::uint8_t>(kZero + packet.more));
  bytes.push_back(kEnd);
  return bytes;
}

std::optional<FalconPacket> FalconPacketParser::next() {
  while (true) {
    while (!buffer_.empty() && buffer_.front() != kInitialize) {
      buffer_.pop_front();
      ++skipped_;
    }
    if (buffer_.size() < kFalconPacketSize) return std::nullopt;
    const auto packet = decode(buffer_);
    const std::size_t used = packet ? kFalconPacketSize : 1;
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(used));
    if (packet) return packet;
    ++skipped_;
  }
}

}  // namespace palpate::emulation
