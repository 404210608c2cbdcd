#include "common/interrupt.h"

#include <atomic>
#include <csignal>
#include <initializer_list>
#include <pthread.h>

#include "common/clock.h"

namespace palpate {
namespace {

sigset_t set_of(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  return set;
}

// A library may have started threads before `main` (OpenBLAS does), which do not block these signals: one of
// them can be handed a signal while the main thread is not waiting. Its handler only leaves a note.
std::atomic<bool> g_stop{false}, g_rearm{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void note(int signal) {
  (signal == SIGUSR1 ? g_rearm : g_stop).store(true, std::memory_order_relaxed);
}

}  // namespace

void block_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1}) std::signal(signal, note);
  const sigset_t set = set_of({SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1});
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  // Neither `haptic_client | head` nor a file that grows beyond its limit may kill a loop.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

bool wait_for_interrupt(Time timeout) {
  const sigset_t set = set_of({SIGINT, SIGTERM, SIGHUP, SIGQUIT});
  const timespec t = to_timespec(timeout);
  return g_stop || sigtimedwait(&set, nullptr, &t) > 0 || g_stop;
}

bool take_rearm_request() {
  const sigset_t set = set_of({SIGUSR1});
  const timespec none{};
  return sigtimedwait(&set, nullptr, &none) > 0 || g_rearm.exchange(false);
}

}  // namespace palpate
