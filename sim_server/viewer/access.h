#pragma once
/// Who may look on, and who may do more. No socket.
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/auth.h"
#include "protocol/endpoint.h"

namespace palpate::sim {

/// Address of the page.
struct ViewerAddress {
  protocol::Endpoint endpoint;
  std::string typed{};  ///< the host, as somebody typed it
};

/// "8080" (on this machine alone), "ADDR:8080" or "[::1]:8080"; nothing of "off". Port 0: any. Throws `Error`
/// that begins with "--viewer".
std::optional<ViewerAddress> read_viewer_address(const std::string& text);

/// True if a page requested the server by a name that is its own: an IP address, "localhost", this machine's
/// name, or the one that was typed. A foreign name that resolves to this machine (DNS rebinding) is none.
/// `host`: the header Host, with or without a port.
bool host_is_ours(std::string_view host, std::string_view typed);

/// True if the page that opens a WebSocket came from this server: `origin` is http(s)://`host`.
bool same_origin(std::string_view origin, std::string_view host);

/// Content-Security-Policy of the page at `host`, a header Host: nothing from other hosts. It names the
/// WebSocket, as "self" means that only in newer browsers.
std::string security_policy(const std::string& host);

using PageToken = std::array<std::uint8_t, 16>;

/// 32 hexadecimal digits.
std::string hex_token(const PageToken& bytes);

/// The token of one run of a server that has this key: good as long as that runs, so that one that was read
/// on its way is worth nothing later. `run`: random.
std::string token_of(const protocol::Key& key, const protocol::Nonce& run);

}  // namespace palpate::sim
