#include "sim_server/viewer/port_probe.h"

#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace palpate::sim {

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

}  // namespace palpate::sim
