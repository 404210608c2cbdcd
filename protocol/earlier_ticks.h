#pragma once
/// Ticks that travel behind a ToolState in the same datagram, so that a slow link carries fewer datagrams and
/// a capture still holds every tick, bit by bit. Bytes: protocol/README.md, "Earlier ticks".
#include <span>
#include <vector>

#include "protocol/codec.h"

namespace palpate::protocol {

/// Ticks that one datagram may hold before its newest.
constexpr std::size_t kMostEarlierTicks = 63;

/// Writes ticks (oldest first, at least one, at most `kMostEarlierTicks` + 1) as one datagram: a ToolState of
/// the newest, and behind it the ticks before. Returns its size, with room for a tag in `kMaxDatagram` bytes;
/// 0 where the ticks do not fit. `out` holds `kMaxDatagram` bytes. No allocation; 0.1 us a tick.
std::size_t encode_ticks(const Header& header, std::span<const ToolState> ticks,
                         std::span<std::byte> out) noexcept;

/// Reads what stands behind the fields of `newest`, whose flag `kHasEarlierTicks` is set: the tick just
/// before it first, then those before that one. `behind`: these bytes; none at all count as no tick. Returns
/// how many ticks `out` holds now, or nothing where the bytes are none that `encode_ticks` writes. `out` has
/// room for `kMostEarlierTicks`.
std::optional<std::size_t> read_earlier_ticks(const ToolState& newest, std::span<const std::byte> behind,
                                              std::span<ToolState> out) noexcept;

/// Returns the ticks of a datagram that `decode` accepted, oldest first, none with the flag
/// `kHasEarlierTicks`. Empty where it is no ToolState. Allocates; for captures, and for links that are slow.
std::vector<ToolState> ticks_of(const Datagram& datagram);

}  // namespace palpate::protocol
