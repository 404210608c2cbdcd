#pragma once
/// UDP datagrams inside the frames of a capture, and frames around UDP datagrams. Pure functions on bytes: no
/// allocation, no read beyond a span, any thread. Costs the headers; building costs the payload, too.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocol/session.h"

namespace palpate::protocol {

/// First header of a frame, by its number in a capture (https://www.tcpdump.org/linktypes.html).
enum class LinkType : int {
  kNull = 0,      ///< BSD loopback: the address family in the order of bytes of the capturing machine
  kEthernet = 1,  ///< up to `kMaxVlanTags` VLAN tags
  kRawLinux = 12,
  kRawOpenBsd = 14,
  kRaw = 101,   ///< IP, its version in its first bits
  kLoop = 108,  ///< OpenBSD loopback: the address family in network order
  kCooked = 113,
  kIpv4 = 228,
  kIpv6 = 229,
  kCooked2 = 276,
};
constexpr int kMaxVlanTags = 4;  // two with IEEE 802.1ad, and as many again
constexpr int kMaxTunnels = 3;   // one within the other
constexpr std::string_view kLinkTypesRead =
    "Ethernet, Linux cooked (SLL, SLL2), raw IP, BSD loopback (NULL, LOOP)";

/// True for the link types above.
bool supported(LinkType link) noexcept;

/// Kind of a frame, as parsed.
enum class FrameVerdict : std::uint8_t {
  kDatagram,      ///< a UDP datagram, perhaps cut
  kOtherTraffic,  ///< not IP, or not UDP
  kFragment,      ///< a part of a UDP datagram
  kMalformed,     ///< lengths do not add up, or the frame ends within its headers
};

/// A UDP datagram in a frame.
struct UdpFrame {
  Endpoint from, to;
  std::span<const std::byte> payload;  ///< of the frame's bytes: those that were captured
  std::size_t length = 0;  ///< of the payload as sent, bytes; above payload.size() when it was cut
};

/// Finds the datagram in a frame. `out` is written only when the verdict is `kDatagram`. Checksums are not
/// looked at: on the machine that sends they are often filled in behind the capture. Of tunnels, VXLAN, GRE,
/// IP in IP and PPPoE, it is the innermost. IPv6 extension headers other than hop-by-hop, routing, fragment
/// and destination options are other traffic.
FrameVerdict parse_frame(LinkType link, std::span<const std::byte> frame, UdpFrame& out) noexcept;

constexpr std::size_t kMaxFrameHeaders = 48;  ///< bytes `build_frame` puts in front of a payload, at most

/// Writes a raw IP frame, the headers and `payload`, and returns its size in bytes. `length`: of the payload
/// as sent, at least payload.size(). The UDP checksum is 0 when the payload is cut. An IPv4 address that
/// talks to an IPv6 one is written as ::ffff:a.b.c.d. Returns 0 when `out` is too small (payload.size() +
/// `kMaxFrameHeaders` is enough) or no datagram has such a length.
std::size_t build_frame(const Endpoint& from, const Endpoint& to, std::span<const std::byte> payload,
                        std::size_t length, std::span<std::byte> out) noexcept;

}  // namespace palpate::protocol
