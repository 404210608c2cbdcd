#include "protocol/link_frames.h"

#include <algorithm>
#include <netinet/in.h>
#include <optional>

namespace palpate::protocol {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::uint16_t kEtherIpv4 = 0x0800, kEtherIpv6 = 0x86dd, kEtherNone = 0;
constexpr std::uint16_t kEtherBridged = 0x6558;     // of GRE: an Ethernet frame
constexpr std::uint16_t kEtherPppSession = 0x8864;  // PPPoE, RFC 2516
constexpr std::uint16_t kVxlanPort = 4789;          // RFC 7348
// Bytes (RFC 791, 8200, 768).
constexpr std::size_t kIpv4Header = 20, kIpv6Header = 40, kUdpHeader = 8, kMaxLengthField = 65535;

std::uint8_t u8(Bytes bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}
std::uint16_t u16(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(u8(bytes, at) << 8 | u8(bytes, at + 1));
}
void put_u16(std::span<std::byte> out, std::size_t at, std::size_t value) {
  out[at] = static_cast<std::byte>(value >> 8 & 0xff);
  out[at + 1] = static_cast<std::byte>(value & 0xff);
}

/// The content of a link header: an EtherType and the bytes behind the header.
struct Carried {
  std::uint16_t type;
  Bytes bytes;
};

/// A header of `size` bytes with the EtherType at `type_at`; nothing when the frame is shorter.
std::optional<Carried> behind_header(Bytes frame, std::size_t type_at, std::size_t size) {
  if (frame.size() < size) return {};
  return Carried{u16(frame, type_at), frame.subspan(size)};
}

std::optional<Carried> behind_ethernet(Bytes frame) {
  return behind_header(frame, 12, 14);
}

std::optional<Carried> behind_loopback(Bytes frame) {
  if (frame.size() < 4) return {};
  // One of the two halves of a small number is 0, whatever the order of bytes.
  const std::uint32_t high = u16(frame, 0), low = u16(frame, 2);
  const std::uint32_t family = high == 0 ? low : low == 0 ? high >> 8 | (high & 0xff) << 8 : 0;
  const bool v6 = family == 10 || family == 24 || family == 28 || family == 30;
  return Carried{family == 2 ? kEtherIpv4 : v6 ? kEtherIpv6 : kEtherNone, frame.subspan(4)};
}

std::optional<Carried> by_version(Bytes frame) {
  if (frame.empty()) return {};
  const int version = u8(frame, 0) >> 4;
  return Carried{version == 4 ? kEtherIpv4 : version == 6 ? kEtherIpv6 : kEtherNone, frame};
}

std::optional<Carried> behind_link(LinkType link, Bytes frame) {
  switch (link) {
    case LinkType::kEthernet:
      return behind_ethernet(frame);
    case LinkType::kCooked:
      return behind_header(frame, 14, 16);
    case LinkType::kCooked2:
      return behind_header(frame, 0, 20);
    case LinkType::kNull:
    case LinkType::kLoop:
      return behind_loopback(frame);
    case LinkType::kRaw:
    case LinkType::kRawLinux:
    case LinkType::kRawOpenBsd:
      return by_version(frame);
    case LinkType::kIpv4:
      return Carried{kEtherIpv4, frame};
    case LinkType::kIpv6:
      return Carried{kEtherIpv6, frame};
  }
  return Carried{kEtherNone, frame};
}

/// Of version 1, type 1, code 0: a session's data.
std::optional<Carried> behind_pppoe(Bytes frame) {
  if (frame.size() < 8) return {};
  const std::uint16_t ppp = u16(frame, 6);
  const bool data = u16(frame, 0) == 0x1100;
  const std::uint16_t type = ppp == 0x0021 ? kEtherIpv4 : ppp == 0x0057 ? kEtherIpv6 : kEtherNone;
  return Carried{data ? type : kEtherNone, frame.subspan(8)};
}

/// GRE, RFC 2784 and 2890: checksum, key and sequence number are there as the first bits say.
std::optional<Carried> behind_gre(Bytes frame) {
  if (frame.size() < 4) return {};
  const std::uint16_t flags = u16(frame, 0);
  if ((flags & 0x7) != 0 || (flags & 0x4000) != 0) return Carried{kEtherNone, frame};  // version 1, routing
  const std::size_t optional =
      4 * std::size_t{((flags >> 15) & 1U) + ((flags >> 13) & 1U) + ((flags >> 12) & 1U)};
  return behind_header(frame, 2, 4 + optional);
}

bool is_vlan(std::uint16_t type) {
  return type == 0x8100 || type == 0x88a8 || type == 0x9100;  // 802.1Q, 802.1ad, QinQ before 802.1ad
}

/// `captured`: what there is of the IP payload, perhaps with padding; `declared`: its length as sent.
FrameVerdict parse_udp(Bytes captured, std::size_t declared, UdpFrame& out) {
  if (captured.size() < kUdpHeader) return FrameVerdict::kMalformed;
  const std::size_t length = u16(captured, 4);
  if (length < kUdpHeader || length > declared) return FrameVerdict::kMalformed;
  out.from.port = u16(captured, 0);
  out.to.port = u16(captured, 2);
  out.length = length - kUdpHeader;
  out.payload = captured.subspan(kUdpHeader);
  out.payload = out.payload.first(std::min(out.payload.size(), out.length));
  return FrameVerdict::kDatagram;
}

FrameVerdict parse_carried(std::optional<Carried> carried, int wrappings, UdpFrame& out);

/// True for what carries our datagrams, itself or in a tunnel.
bool is_carrier(std::uint8_t protocol) {
  return protocol == IPPROTO_UDP || protocol == IPPROTO_GRE || protocol == IPPROTO_IPIP ||
         protocol == IPPROTO_IPV6;
}

/// `captured`, `declared`: as `parse_udp`. `wrappings`: those around it.
FrameVerdict parse_payload(std::uint8_t protocol, Bytes captured, std::size_t declared, int wrappings,
                           UdpFrame& out) {
  const Bytes inner = captured.first(std::min(captured.size(), declared));
  if (protocol == IPPROTO_IPIP) return parse_carried(Carried{kEtherIpv4, inner}, wrappings + 1, out);
  if (protocol == IPPROTO_IPV6) return parse_carried(Carried{kEtherIpv6, inner}, wrappings + 1, out);
  if (protocol == IPPROTO_GRE) {
    std::optional<Carried> carried = behind_gre(inner);
    if (carried && carried->type == kEtherBridged) carried = behind_ethernet(carried->bytes);
    return parse_carried(carried, wrappings + 1, out);
  }
  const FrameVerdict verdict = parse_udp(captured, declared, out);
  const Bytes payload = out.payload;
  const bool vxlan = verdict == FrameVerdict::kDatagram && out.to.port == kVxlanPort && payload.size() >= 8 &&
                     u8(payload, 0) == 0x08 && u8(payload, 7) == 0;
  return vxlan ? parse_carried(behind_ethernet(payload.subspan(8)), wrappings + 1, out) : verdict;
}

FrameVerdict parse_ipv4(Bytes packet, int wrappings, UdpFrame& out) {
  if (packet.size() < kIpv4Header) return FrameVerdict::kMalformed;
  const std::size_t header = 4 * (u8(packet, 0) & 0xfu), total = u16(packet, 2);
  if (u8(packet, 0) >> 4 != 4 || header < kIpv4Header) return FrameVerdict::kMalformed;
  if (!is_carrier(u8(packet, 9))) return FrameVerdict::kOtherTraffic;
  if (total < header || packet.size() < header) return FrameVerdict::kMalformed;
  if ((u16(packet, 6) & 0x3fff) != 0) return FrameVerdict::kFragment;  // more fragments, or an offset
  out.from = out.to = {};
  std::copy_n(packet.begin() + 12, 4, reinterpret_cast<std::byte*>(out.from.address.data()));
  std::copy_n(packet.begin() + 16, 4, reinterpret_cast<std::byte*>(out.to.address.data()));
  return parse_payload(u8(packet, 9), packet.subspan(header), total - header, wrappings, out);
}

bool is_extension(std::uint8_t header) {
  return header == IPPROTO_HOPOPTS || header == IPPROTO_ROUTING || header == IPPROTO_FRAGMENT ||
         header == IPPROTO_DSTOPTS;
}

/// Moves `at` behind the extension headers and `next` to what they carry. `kDatagram`: it may carry one.
FrameVerdict skip_extensions(Bytes packet, std::uint8_t& next, std::size_t& at) {
  while (is_extension(next)) {
    if (packet.size() - at < 8) return FrameVerdict::kMalformed;
    const bool fragment = next == IPPROTO_FRAGMENT;
    const std::size_t size = fragment ? 8 : 8 * (u8(packet, at + 1) + std::size_t{1});
    if (packet.size() - at < size) return FrameVerdict::kMalformed;
    next = u8(packet, at);
    if (fragment && (u16(packet, at + 2) & 0xfff9) != 0 && (is_carrier(next) || is_extension(next))) {
      return FrameVerdict::kFragment;
    }
    at += size;
  }
  return is_carrier(next) ? FrameVerdict::kDatagram : FrameVerdict::kOtherTraffic;
}

FrameVerdict parse_ipv6(Bytes packet, int wrappings, UdpFrame& out) {
  if (packet.size() < kIpv6Header || u8(packet, 0) >> 4 != 6) return FrameVerdict::kMalformed;
  const std::size_t total = kIpv6Header + u16(packet, 4);
  packet = packet.first(std::min(packet.size(), total));
  std::uint8_t next = u8(packet, 6);
  std::size_t at = kIpv6Header;
  const FrameVerdict verdict = skip_extensions(packet, next, at);
  if (verdict != FrameVerdict::kDatagram) return verdict;
  std::copy_n(packet.begin() + 8, 16, reinterpret_cast<std::byte*>(out.from.address.data()));
  std::copy_n(packet.begin() + 24, 16, reinterpret_cast<std::byte*>(out.to.address.data()));
  out.from.v6 = out.to.v6 = true;
  return parse_payload(next, packet.subspan(at), total - at, wrappings, out);
}

/// Finds the datagram behind VLAN tags and PPPoE.
FrameVerdict parse_carried(std::optional<Carried> carried, int wrappings, UdpFrame& out) {
  for (int tags = 0; tags < kMaxVlanTags && carried && is_vlan(carried->type); ++tags) {
    carried = behind_header(carried->bytes, 2, 4);
  }
  if (carried && carried->type == kEtherPppSession) carried = behind_pppoe(carried->bytes);
  if (!carried) return FrameVerdict::kMalformed;
  if (wrappings > kMaxTunnels) return FrameVerdict::kOtherTraffic;
  if (carried->type == kEtherIpv4) return parse_ipv4(carried->bytes, wrappings, out);
  if (carried->type == kEtherIpv6) return parse_ipv6(carried->bytes, wrappings, out);
  return FrameVerdict::kOtherTraffic;
}

/// Adds 16-bit words in network order to a one's-complement sum (RFC 1071). A frame's worth cannot overflow
/// it.
std::uint32_t add_words(Bytes bytes, std::uint32_t sum) {
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) sum += u16(bytes, i);
  if (bytes.size() % 2 == 1) sum += std::uint32_t{u8(bytes, bytes.size() - 1)} << 8;
  return sum;
}

std::size_t checksum(std::uint32_t sum) {
  while (sum > 0xffff) sum = (sum & 0xffff) + (sum >> 16);
  return ~sum & 0xffff;
}

/// `out`: zeros, the header's 20 bytes.
void put_ipv4(const Endpoint& from, const Endpoint& to, std::size_t total, std::span<std::byte> out) {
  put_u16(out, 0, 0x4500);  // version 4, five words of header
  put_u16(out, 2, total);
  put_u16(out, 6, 0x4000);  // do not fragment
  put_u16(out, 8, 64 << 8 | IPPROTO_UDP);
  std::copy_n(reinterpret_cast<const std::byte*>(from.address.data()), 4, out.begin() + 12);
  std::copy_n(reinterpret_cast<const std::byte*>(to.address.data()), 4, out.begin() + 16);
  put_u16(out, 10, checksum(add_words(out, 0)));
}

/// `out`: zeros, the header's 40 bytes.
void put_ipv6(const Endpoint& from, const Endpoint& to, std::size_t carried, std::span<std::byte> out) {
  put_u16(out, 0, 0x6000);  // version 6
  put_u16(out, 4, carried);
  put_u16(out, 6, IPPROTO_UDP << 8 | 64);
  std::copy_n(reinterpret_cast<const std::byte*>(from.address.data()), 16, out.begin() + 8);
  std::copy_n(reinterpret_cast<const std::byte*>(to.address.data()), 16, out.begin() + 24);
}

Endpoint as_v6(const Endpoint& endpoint) {
  if (endpoint.v6) return endpoint;
  Endpoint mapped{.port = endpoint.port, .v6 = true};
  mapped.address[10] = mapped.address[11] = 0xff;
  std::copy_n(endpoint.address.begin(), 4, mapped.address.begin() + 12);
  return mapped;
}

}  // namespace

bool supported(LinkType link) noexcept {
  switch (link) {
    case LinkType::kNull:
    case LinkType::kEthernet:
    case LinkType::kRawLinux:
    case LinkType::kRawOpenBsd:
    case LinkType::kRaw:
    case LinkType::kLoop:
    case LinkType::kCooked:
    case LinkType::kIpv4:
    case LinkType::kIpv6:
    case LinkType::kCooked2:
      return true;
  }
  return false;
}

FrameVerdict parse_frame(LinkType link, std::span<const std::byte> frame, UdpFrame& out) noexcept {
  UdpFrame found;
  const FrameVerdict verdict = parse_carried(behind_link(link, frame), 0, found);
  if (verdict == FrameVerdict::kDatagram) out = found;
  return verdict;
}

std::size_t build_frame(const Endpoint& from, const Endpoint& to, std::span<const std::byte> payload,
                        std::size_t length, std::span<std::byte> out) noexcept {
  if (from.v6 != to.v6) return build_frame(as_v6(from), as_v6(to), payload, length, out);
  const std::size_t ip = from.v6 ? kIpv6Header : kIpv4Header, headers = ip + kUdpHeader;
  const std::size_t longest = kMaxLengthField - kUdpHeader - (from.v6 ? 0 : kIpv4Header);
  if (length > longest || payload.size() > length || out.size() < headers + payload.size()) return 0;
  std::fill_n(out.begin(), headers, std::byte{0});
  std::ranges::copy(payload, out.begin() + static_cast<std::ptrdiff_t>(headers));
  if (from.v6) {
    put_ipv6(from, to, kUdpHeader + length, out.first(ip));
  } else {
    put_ipv4(from, to, headers + length, out.first(ip));
  }
  const std::span<std::byte> udp = out.subspan(ip, kUdpHeader + payload.size());
  put_u16(udp, 0, from.port);
  put_u16(udp, 2, to.port);
  put_u16(udp, 4, kUdpHeader + length);
  if (payload.size() == length) {
    // The pseudo header: both addresses, the protocol and the length.
    const Bytes addresses = from.v6 ? out.subspan(8, 32) : out.subspan(12, 8);
    const auto rest = static_cast<std::uint32_t>(IPPROTO_UDP + kUdpHeader + length);
    const std::size_t sum = checksum(add_words(udp, add_words(addresses, rest)));
    put_u16(udp, 6, sum == 0 ? 0xffff : sum);  // 0 would say that there is none
  }
  return headers + payload.size();
}

}  // namespace palpate::protocol
