#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "protocol/endpoint.h"
#include "protocol/messages.h"

namespace palpate::protocol {

/// Hashes of what the forces of a scene follow from. A session in virtual time has them in place of the
/// nonce of its server, which nobody draws there, so that a capture tells of which scene it is.
struct ScenePrint {
  std::uint32_t mesh = 0;      ///< tetrahedra at rest
  std::uint32_t material = 0;  ///< with inclusions, and what cutting takes
  std::uint32_t supports = 0;  ///< fixed vertices and loads
  std::uint32_t tools = 0;     ///< their shapes, and the name of the model
  bool operator==(const ScenePrint&) const = default;
};

/// Address of an end of a session in virtual time (for documentation, RFC 5737): 192.0.2.`last`.
Endpoint virtual_address(std::uint8_t last, std::uint16_t port) noexcept;
/// Address of the server of a session in virtual time.
Endpoint virtual_server() noexcept;

Nonce nonce_of(const ScenePrint& print) noexcept;
/// Returns the print in a Welcome from this address; nothing in one of a server whose nonce was drawn.
std::optional<ScenePrint> print_in(const Welcome& welcome, const Endpoint& from) noexcept;

/// Returns in words what differs, as "mesh, material"; empty: nothing does.
std::string differences(const ScenePrint& a, const ScenePrint& b);

}  // namespace palpate::protocol
