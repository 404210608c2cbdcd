#include "haptic_client/commands/link_causes.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <ifaddrs.h>
#include <memory>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/resource.h>

#include "common/realtime.h"
#include "haptic_client/session/haptic_loop.h"
#include "protocol/key_file.h"

namespace palpate::client {
namespace {

std::string first_word(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string word;
  in >> word;
  return word;
}

/// An address of an interface of IPv4, in the order of bytes of this machine.
struct Interface {
  std::string name;
  std::uint32_t address = 0, mask = 0;
};

std::uint32_t ipv4_of(const sockaddr* address) {
  sockaddr_in in{};
  std::memcpy(&in, address, sizeof in);
  return ntohl(in.sin_addr.s_addr);
}

std::vector<Interface> interfaces() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(first, &freeifaddrs);
  std::vector<Interface> all;
  for (const ifaddrs* next = first; next != nullptr; next = next->ifa_next) {
    if (next->ifa_addr == nullptr || next->ifa_netmask == nullptr || next->ifa_addr->sa_family != AF_INET)
      continue;
    if ((next->ifa_flags & IFF_UP) == 0) continue;
    all.push_back({next->ifa_name, ipv4_of(next->ifa_addr), ipv4_of(next->ifa_netmask)});
  }
  return all;
}

bool is_wireless(const std::string& interface) {
  return std::filesystem::exists("/sys/class/net/" + interface + "/wireless");
}

}  // namespace

std::vector<std::string> machine_causes() {
  std::vector<std::string> causes;
  if (const std::string governor = first_word("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
      !governor.empty() && governor != "performance") {
    causes.push_back(
        fmt::format("the processor's governor is \"{}\", which wakes slowly: `sudo cpupower frequency-set -g "
                    "performance`",
                    governor));
  }
  rlimit limit{};
  if (getrlimit(RLIMIT_RTPRIO, &limit) == 0 &&
      limit.rlim_cur < static_cast<rlim_t>(row_of(ThreadRole::kHaptic).realtime) && geteuid() != 0)
    causes.push_back("no real-time priority (rtprio): see haptic_client/session/REALTIME.md");
  if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && geteuid() != 0)
    causes.push_back(
        "memory cannot be locked (memlock), so a tick may wait for a page: see "
        "haptic_client/session/REALTIME.md");
  return causes;
}

std::vector<std::string> link_causes(const protocol::Endpoint& local) {
  std::vector<std::string> causes = machine_causes();
  if (local.v6 || protocol::is_loopback(local)) return causes;
  const auto& a = local.address;
  const std::uint32_t own =
      std::uint32_t{a[0]} << 24 | std::uint32_t{a[1]} << 16 | std::uint32_t{a[2]} << 8 | a[3];
  const std::vector<Interface> all = interfaces();
  const auto route = std::ranges::find_if(all, [&](const Interface& i) { return i.address == own; });
  if (route == all.end()) return causes;
  if (is_wireless(route->name))
    causes.push_back(fmt::format("the route goes over {}, which is wireless: use a cable", route->name));
  else
    causes.push_back(
        fmt::format("if round trips come in steps of tens of us, {} coalesces interrupts: `sudo ethtool -C "
                    "{} rx-usecs 0`",
                    route->name, route->name));
  for (const Interface& other : all) {
    if (other.name == route->name || (other.address & other.mask) != (own & route->mask) ||
        other.mask != route->mask)
      continue;
    causes.push_back(
        fmt::format("{} is in the same network as {}, and answers may come by either: take one down",
                    other.name, route->name));
  }
  return causes;
}

}  // namespace palpate::client
