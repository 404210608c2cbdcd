#include "common/interrupt.h"

#include <csignal>
#include <initializer_list>
#include <pthread.h>

namespace palpate {
namespace {

sigset_t set_of(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  return set;
}

}  // namespace

void block_interrupts() {
  const sigset_t set = set_of({SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1});
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::signal(SIGPIPE,
              SIG_IGN);  // NOLINT(bugprone-unused-return-value): `palpate | head` must not kill the loop
}

bool wait_for_interrupt(Time timeout) {
  const sigset_t set = set_of({SIGINT, SIGTERM, SIGHUP, SIGQUIT});
  const timespec t{timeout.count() / 1'000'000'000, timeout.count() % 1'000'000'000};
  return sigtimedwait(&set, nullptr, &t) > 0;
}

bool take_rearm_request() {
  const sigset_t set = set_of({SIGUSR1});
  const timespec none{};
  return sigtimedwait(&set, nullptr, &none) > 0;
}

}  // namespace palpate
