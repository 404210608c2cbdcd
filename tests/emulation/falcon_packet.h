#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace palpate::emulation {

using Bytes = std::vector<std::uint8_t>;

/// The Falcon's 16-byte packet: '<', three numbers of four nibbles each (the lowest first, 'A' is 0), two
/// bytes of flags (0 is 'A'), '>'. Both directions have the same shape.
struct FalconPacket {
  std::array<std::int16_t, 3> numbers{};  ///< to the device: motors, DAC units; from it: encoders, counts
  std::uint8_t flags = 0;                 ///< see the bits below
  std::uint8_t more = 0;                  ///< not used

  bool operator==(const FalconPacket&) const = default;
};
constexpr std::size_t kFalconPacketSize = 16;

// Flags to the device.
constexpr std::uint8_t kHomingBit = 1, kGreenBit = 2, kBlueBit = 4, kRedBit = 8;
// Flags from the device: bits 0 to 3 are the buttons, and from here on the references found.
constexpr int kHomedShift = 4;

Bytes encode(const FalconPacket& packet);

/// Cuts a stream of bytes into packets: what stands before a '<' is skipped, and a '<' whose packet is not
/// sound is.
class FalconPacketParser {
 public:
  void feed(std::uint8_t byte) { buffer_.push_back(byte); }
  /// The next packet, if it is complete.
  std::optional<FalconPacket> next();
  void clear() { buffer_.clear(); }
  /// Bytes thrown away so far.
  std::uint64_t skipped() const { return skipped_; }

 private:
  std::deque<std::uint8_t> buffer_;
  std::uint64_t skipped_ = 0;
};

}  // namespace palpate::emulation
