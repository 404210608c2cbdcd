#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/error.h"
#include "protocol/udp_socket.h"
#include "sim_server/viewer/viewer.h"

namespace palpate::sim {
namespace {

/// Why this address cannot be listened on (TCP), in words; empty: it can. Listens there for a moment.
std::string why_not(const protocol::Endpoint& endpoint) {
  const int fd = socket(endpoint.v6 ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return endpoint.v6 && errno == EAFNOSUPPORT ? "this machine has no IPv6" : std::strerror(errno);
  sockaddr_in6 v6{};
  sockaddr_in v4{};
  v6.sin6_family = AF_INET6, v6.sin6_port = htons(endpoint.port), v6.sin6_scope_id = endpoint.scope;
  v4.sin_family = AF_INET, v4.sin_port = htons(endpoint.port);
  std::memcpy(&v6.sin6_addr, endpoint.address.data(), sizeof v6.sin6_addr);
  std::memcpy(&v4.sin_addr, endpoint.address.data(), sizeof v4.sin_addr);
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool bound = endpoint.v6 ? bind(fd, reinterpret_cast<const sockaddr*>(&v6), sizeof v6) == 0
                                 : bind(fd, reinterpret_cast<const sockaddr*>(&v4), sizeof v4) == 0;
  const int why = !bound || listen(fd, 1) != 0 ? errno : 0;
  ::close(fd);
  if (why == EADDRINUSE) return "another program listens there; choose another port";
  if (why == EACCES) return "ports below 1024 need root; choose another port";
  if (why == EADDRNOTAVAIL) return "this machine has no such address";
  return why == 0 ? "" : std::strerror(why);
}

}  // namespace

void require_free(const ViewerAddress& address) {
  const std::string why = why_not(address.endpoint);
  if (!why.empty())
    fail("--viewer: cannot listen on {} (TCP): {}", protocol::to_string(address.endpoint), why);
}

}  // namespace palpate::sim
