#include "sim_server/viewer/access.h"

#include <algorithm>
#include <arpa/inet.h>
#include <cctype>
#include <unistd.h>

#include "common/error.h"
#include "protocol/udp_socket.h"

namespace palpate::sim {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

bool is_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Without port and brackets; empty where it is none.
std::string name_of_host(std::string_view host) {
  if (host.empty() || host.size() > 255) return {};
  if (host.front() == '[') {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return {};
    const std::string_view rest = host.substr(end + 1);
    if (!rest.empty() && (rest.front() != ':' || !is_digits(rest.substr(1)))) return {};
    return lower(host.substr(1, end - 1));
  }
  const std::size_t colon = host.find(':');
  if (colon != std::string_view::npos && !is_digits(host.substr(colon + 1))) return {};
  return lower(host.substr(0, colon));
}

/// No name, so nobody's answer can lead it elsewhere.
bool is_ip_address(const std::string& name) {
  in6_addr ignored{};
  return inet_pton(AF_INET, name.c_str(), &ignored) == 1 || inet_pton(AF_INET6, name.c_str(), &ignored) == 1;
}

std::string machine_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? lower(name.data()) : std::string();
}

}  // namespace

std::optional<ViewerAddress> read_viewer_address(const std::string& text) {
  if (text == "off") return {};
  const std::string complete = is_digits(text) ? "127.0.0.1:" + text : text;
  try {
    ViewerAddress address{protocol::resolve(complete, "--viewer")};
    address.typed = name_of_host(complete);
    return address;
  } catch (const Error&) {
    fail("--viewer: \"{}\" is no address; expected PORT, ADDR:PORT or off, such as 8080 or 0.0.0.0:8080",
         text);
  }
}

bool host_is_ours(std::string_view host, std::string_view typed) {
  const std::string name = name_of_host(host);
  if (name.empty()) return false;
  if (name == "localhost" || is_ip_address(name) || name == lower(typed)) return true;
  const std::string machine = machine_name();
  return !machine.empty() && (name == machine || name == machine + ".local");
}

bool same_origin(std::string_view origin, std::string_view host) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme))
      return !host.empty() && lower(origin.substr(scheme.size())) == lower(host);
  }
  return false;
}

std::string security_policy(const std::string& host) {
  return "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; media-src "
         "blob:; "
         "connect-src 'self' ws://" +
         host + "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

std::string hex_token(const PageToken& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

std::string token_of(const protocol::Key& key, const protocol::Nonce& run) {
  return hex_token(protocol::page_token(direction_key(key, protocol::Direction::kToClient, run, {})));
}

}  // namespace palpate::sim
