#pragma once
#include <cstddef>
#include <optional>
#include <span>

#include "protocol/messages.h"

namespace palpate::protocol {

constexpr std::uint8_t kProtocolVersion = 2;  ///< grows when the layout of a message changes
/// Offsets in the header.
enum HeaderOffset : std::size_t { kVersionAt = 4, kPayloadAt = 6, kTagLengthAt = 8, kKeyNumberAt = 9 };
constexpr std::size_t kHeaderBytes = 28;    ///< protocol/README.md, "Header"
constexpr std::size_t kTagBytes = 16;       ///< room behind the payload for an authentication tag
constexpr std::size_t kMaxDatagram = 1200;  ///< fits every path that carries IPv6
constexpr std::size_t kHelloPayload = 256;  ///< Hello is padded to this, more than any answer to it

/// Header of every message.
struct Header {
  std::uint64_t session = 0;   ///< drawn by the server; 0 before there is one
  std::uint64_t sequence = 0;  ///< of this datagram from this sender in this session, from 1
  std::uint8_t key = 0;        ///< read: the number of the key of its tag; written by `seal`
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
  // Those below are a session's, not `decode`'s:
  kTag,        ///< no tag of our key
  kSession,    ///< of no session known here, or from another address than the session's
  kTool,       ///< of another tool than the session's
  kDirection,  ///< a message that only the other end sends
};
constexpr std::size_t kVerdicts = static_cast<std::size_t>(Verdict::kDirection) + 1;  ///< the last, and 0

/// "tag" of kTag, and so on: a key for reports.
const char* name_of(Verdict verdict) noexcept;

struct Datagram {
  Header header;
  Message message;
  std::span<const std::byte> bytes{};  ///< what it was read from; valid as long as those
};

/// True if it is within the bounds of the protocol. A state without terms is an absent one, and valid.
bool valid(const RelaxedState& m) noexcept;
/// True if these are loads on modes of any organ.
bool valid(const ModalLoads& m) noexcept;
/// True if each of its fields is within the bounds of the protocol.
bool valid(const ToolState& m) noexcept;

/// Writes one datagram and returns its size, at most `kMaxDatagram`. `out` must hold that many bytes. No
/// allocation.
std::size_t encode(const Header& header, const Message& message, std::span<std::byte> out) noexcept;

/// Sets the size of the payload of a datagram that `encode` wrote, where more was appended.
void set_payload_size(std::span<std::byte> datagram, std::size_t payload) noexcept;
/// Returns the bytes of a ToolState's payload that stand behind its fields; empty of any other message.
std::span<const std::byte> behind_fields(const Datagram& datagram) noexcept;

/// The version of a datagram of ours that is not of this one, and whether that is a Hello.
struct OtherVersion {
  std::uint8_t version = 0;
  bool hello = false;
};
std::optional<OtherVersion> other_version(std::span<const std::byte> in) noexcept;

/// Reads one datagram but for earlier ticks behind a ToolState, which may take 20 times as long as all else
/// (`decode_earlier`): a session reads those once it knows that the tag is right. `out` is written only when
/// the verdict is `kAccepted`. Never reads beyond `in`, never allocates.
Verdict decode_fields(std::span<const std::byte> in, Datagram& out) noexcept;
/// Reads what stands behind the fields of such a datagram: `kValue` where it says that earlier ticks follow,
/// and what follows is none. Never allocates.
Verdict decode_earlier(const Datagram& datagram) noexcept;
/// Does both, for captures.
Verdict decode(std::span<const std::byte> in, Datagram& out) noexcept;

}  // namespace palpate::protocol
