#pragma once
#include <optional>
#include <span>
#include <system_error>

#include "common/time.h"
#include "protocol/endpoint.h"

namespace palpate::protocol {

/// A datagram as the kernel gives it.
struct ReceivedDatagram {
  std::size_t size = 0;  ///< bytes
  Endpoint from;         ///< who sent it
  Endpoint to;           ///< which of our addresses it was sent to; port 0: not known
  Time at{};             ///< when the kernel had it, this machine's monotonic clock
};

/// Asks the kernel to tell of each datagram when it came and to which of our addresses (SO_TIMESTAMPNS,
/// IP_PKTINFO or, `v6`, IPV6_RECVPKTINFO; Linux). What it does not grant, `receive` fills in as it can.
void request_ancillary(int socket, bool v6) noexcept;

/// The next datagram that waits in a socket that does not block, into `buffer`; what is longer is cut. None
/// where there is none, or where the system reports an earlier one that could not be delivered: `failed` then
/// says which. No allocation.
std::optional<ReceivedDatagram> receive(int socket, std::span<std::byte> buffer,
                                        std::error_code& failed) noexcept;

/// Sends from that address of ours; port 0: from the one that the routes choose. No allocation.
std::error_code send(int socket, std::span<const std::byte> datagram, const Endpoint& to,
                     const Endpoint& from) noexcept;

}  // namespace palpate::protocol
