#pragma once
#include <cstddef>
#include <span>

#include "protocol/messages.h"

namespace palpate::protocol {

constexpr std::uint8_t kProtocolVersion = 1;
constexpr std::size_t kHeaderBytes = 28;
constexpr std::size_t kTagBytes = 16;       ///< room behind the payload for an authentication tag
constexpr std::size_t kMaxDatagram = 1200;  ///< fits every path that carries IPv6
constexpr std::size_t kHelloPayload = 256;  ///< Hello is padded to this, more than any answer to it

/// What stands in front of every message.
struct Header {
  std::uint64_t session = 0;   ///< drawn by the server; 0 before there is one
  std::uint64_t sequence = 0;  ///< of this datagram from this sender in this session, from 1
};

/// Why a datagram was refused. `kAccepted` means it was not.
enum class Verdict : std::uint8_t {
  kAccepted,
  kTooShort,   ///< no room for a header
  kNotOurs,    ///< wrong magic
  kVersion,    ///< another protocol version
  kType,       ///< unknown or reserved message type
  kLength,     ///< lengths do not add up, or the payload is too short for its type
  kNotFinite,  ///< a NaN or an infinity
  kValue,      ///< a field outside its range
};
constexpr std::size_t kVerdicts = 8;

struct Datagram {
  Header header;
  Message message;
};

/// Writes one datagram and returns its size, at most `kMaxDatagram`. `out` must hold that many bytes. No
/// allocation.
std::size_t encode(const Header& header, const Message& message, std::span<std::byte> out) noexcept;

/// Reads one datagram. `out` is written only when the verdict is `kAccepted`. Never reads beyond `in`, never
/// allocates.
Verdict decode(std::span<const std::byte> in, Datagram& out) noexcept;

}  // namespace palpate::protocol
