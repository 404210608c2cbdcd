#pragma once
#include <array>
#include <compare>
#include <cstdint>

namespace palpate::protocol {

/// An IP address and port, in network order of bytes.
struct Endpoint {
  std::array<std::uint8_t, 16> address{};  ///< IPv4 in the first four
  std::uint16_t port = 0;
  bool v6 = false;
  std::uint32_t scope = 0;  ///< of a link-local IPv6 address: the number of the interface
  auto operator<=>(const Endpoint&) const = default;
};

}  // namespace palpate::protocol
