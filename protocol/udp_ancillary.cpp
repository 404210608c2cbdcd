#include "protocol/udp_ancillary.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>

#include "common/clock.h"

namespace palpate::protocol {
namespace {

constexpr Time kLongestWait =
    std::chrono::milliseconds(100);  // between the kernel and us; more is a clock that jumped

Endpoint endpoint_of(const sockaddr_storage& address) noexcept {
  Endpoint result;
  if (address.ss_family == AF_INET6) {
    sockaddr_in6 v6{};
    std::memcpy(&v6, &address, sizeof v6);
    std::memcpy(result.address.data(), &v6.sin6_addr, 16);
    result.port = ntohs(v6.sin6_port);
    result.scope = v6.sin6_scope_id;
    result.v6 = true;
  } else {
    sockaddr_in v4{};
    std::memcpy(&v4, &address, sizeof v4);
    std::memcpy(result.address.data(), &v4.sin_addr, 4);
    result.port = ntohs(v4.sin_port);
  }
  return result;
}

socklen_t fill(sockaddr_storage& out, const Endpoint& endpoint) noexcept {
  if (endpoint.v6) {
    sockaddr_in6 v6{};
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(endpoint.port);
    v6.sin6_scope_id = endpoint.scope;
    std::memcpy(&v6.sin6_addr, endpoint.address.data(), 16);
    std::memcpy(&out, &v6, sizeof v6);
    return sizeof v6;
  }
  sockaddr_in v4{};
  v4.sin_family = AF_INET;
  v4.sin_port = htons(endpoint.port);
  std::memcpy(&v4.sin_addr, endpoint.address.data(), 4);
  std::memcpy(&out, &v4, sizeof v4);
  return sizeof v4;
}

/// The kernel stamps by the calendar's clock.
Time monotonic(const timespec& stamp) noexcept {
  const Time t = from_timespec(stamp) - monotonic_epoch(), local = now();
  return std::clamp(t, local - kLongestWait, local);
}

template <class T>
T read(const cmsghdr& header) noexcept {
  T value{};
  std::memcpy(&value, CMSG_DATA(&header), sizeof value);
  return value;
}

void note(const cmsghdr& header, ReceivedDatagram& out) noexcept {
  if (header.cmsg_level == SOL_SOCKET && header.cmsg_type == SCM_TIMESTAMPNS) {
    out.at = monotonic(read<timespec>(header));
  } else if (header.cmsg_level == IPPROTO_IP && header.cmsg_type == IP_PKTINFO) {
    const auto info = read<in_pktinfo>(header);
    std::memcpy(out.to.address.data(), &info.ipi_spec_dst, 4);  // of a broadcast, the interface's own
    out.to.port = 1;
  } else if (header.cmsg_level == IPPROTO_IPV6 && header.cmsg_type == IPV6_PKTINFO) {
    const auto info = read<in6_pktinfo>(header);
    if (IN6_IS_ADDR_MULTICAST(&info.ipi6_addr)) return;
    std::memcpy(out.to.address.data(), &info.ipi6_addr, 16);
    if (IN6_IS_ADDR_LINKLOCAL(&info.ipi6_addr)) out.to.scope = info.ipi6_ifindex;
    out.to.v6 = true;
    out.to.port = 1;
  }
}

/// Puts one piece of ancillary data into `control`.
template <class T>
void put(msghdr& message, std::span<std::byte> control, int level, int type, const T& value) noexcept {
  message.msg_control = control.data();
  message.msg_controllen = CMSG_SPACE(sizeof value);
  cmsghdr* const header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = level;
  header->cmsg_type = type;
  header->cmsg_len = CMSG_LEN(sizeof value);
  std::memcpy(CMSG_DATA(header), &value, sizeof value);
}

}  // namespace

void request_ancillary(int socket, bool v6) noexcept {
  const int on = 1;
  setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  if (v6) {
    setsockopt(socket, IPPROTO_IPV6, IPV6_RECVPKTINFO, &on, sizeof on);
  } else {
    setsockopt(socket, IPPROTO_IP, IP_PKTINFO, &on, sizeof on);
  }
}

std::optional<ReceivedDatagram> receive(int socket, std::span<std::byte> buffer,
                                        std::error_code& failed) noexcept {
  alignas(cmsghdr) std::array<std::byte, 256> control;
  sockaddr_storage from{};
  iovec bytes{buffer.data(), buffer.size()};
  msghdr message{};
  message.msg_name = &from;
  message.msg_namelen = sizeof from;
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(socket, &message, 0);
  if (size < 0) {
    failed = {errno, std::system_category()};
    return {};
  }
  failed.clear();
  ReceivedDatagram datagram{.size = static_cast<std::size_t>(size), .from = endpoint_of(from), .to = {}};
  for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header))
    note(*header, datagram);
  if (datagram.at == Time{}) datagram.at = now();
  return datagram;
}

std::error_code send(int socket, std::span<const std::byte> datagram, const Endpoint& to,
                     const Endpoint& from) noexcept {
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(in6_pktinfo))> control{};
  sockaddr_storage address{};
  iovec bytes{const_cast<std::byte*>(datagram.data()), datagram.size()};
  msghdr message{};
  message.msg_name = &address;
  message.msg_namelen = fill(address, to);
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  if (from.port != 0 && from.v6 == to.v6) {
    if (from.v6) {
      in6_pktinfo info{};
      std::memcpy(&info.ipi6_addr, from.address.data(), 16);
      info.ipi6_ifindex = from.scope;
      put(message, control, IPPROTO_IPV6, IPV6_PKTINFO, info);
    } else {
      in_pktinfo info{};
      std::memcpy(&info.ipi_spec_dst, from.address.data(), 4);
      put(message, control, IPPROTO_IP, IP_PKTINFO, info);
    }
  }
  if (sendmsg(socket, &message, 0) < 0) return {errno, std::system_category()};
  return {};
}

}  // namespace palpate::protocol
