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

void name_thread(const char* name) {
  pthread_setname_np(pthread_self(), name);
}

void make_ordinary(const char* name) {
  name_thread(name);
  const sched_param param{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &param);
}

void make_background(const char* name) {
  constexpr int kNice = 10;  // behind any thread that steps or renders
  make_ordinary(name);
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);  // of this thread alone, on Linux
}

std::string make_realtime(pthread_t thread, const char* name, int priority) {
  pthread_setname_np(thread, name);
  sched_param param{};
  param.sched_priority = priority;
  const int refused = pthread_setschedparam(thread, SCHED_FIFO, &param);
  if (refused == 0) return {};
  return fmt::format(
      "no real-time priority for the {} thread ({}): raise `ulimit -r` (rtprio in "
      "/etc/security/limits.conf)",
      name, std::strerror(refused));
}

}  // namespace palpate
