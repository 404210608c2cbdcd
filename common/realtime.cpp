#include "common/realtime.h"

#include <cerrno>
#include <cstring>
#include <fmt/core.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace palpate {

std::string lock_memory() {
  // MCL_ONFAULT: pages are locked as they are first touched, so a large address space costs nothing.
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0) return {};
  return fmt::format("memory is not locked ({}): raise `ulimit -l` (memlock in /etc/security/limits.conf)",
                     std::strerror(errno));
}

std::string take_role(ThreadRole role, const char* name) {
  const std::string refused = give_role(pthread_self(), role);
  if (name != nullptr) pthread_setname_np(pthread_self(), name);
  if (row_of(role).nice != 0) {
    const int others = getpriority(PRIO_PROCESS, static_cast<id_t>(getpid()));  // the first thread, on Linux
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), others + row_of(role).nice);  // this thread alone
  }
  return refused;
}

std::string give_role(pthread_t thread, ThreadRole role) {
  const ThreadRow& row = row_of(role);
  pthread_setname_np(thread, row.name);
  sched_param param{};
  param.sched_priority = row.realtime;
  const int refused = pthread_setschedparam(thread, row.realtime > 0 ? SCHED_FIFO : SCHED_OTHER, &param);
  if (refused == 0) return {};
  return fmt::format(
      "no real-time priority for the {} thread ({}): raise `ulimit -r` (rtprio in "
      "/etc/security/limits.conf)",
      row.name, std::strerror(refused));
}

std::string give_roles(std::initializer_list<std::pair<pthread_t, ThreadRole>> threads) {
  std::string first;
  for (const auto& [thread, role] : threads) {
    const std::string refused = give_role(thread, role);
    if (first.empty()) first = refused;
  }
  return first;
}

}  // namespace palpate
