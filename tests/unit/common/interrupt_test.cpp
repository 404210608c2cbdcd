#include "common/interrupt.h"

#include <csignal>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/support/catch.h"

using namespace std::chrono_literals;

namespace {

/// Runs `body` in a child process; its exit code, or minus the signal that ended it.
template <class Body>
int in_child(Body body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace

TEST_CASE("Ctrl-C that lands on a thread older than main, while nobody waits, is not lost and does not kill",
          "[threads]") {
  const int code = in_child([] {
    // Like the threads a BLAS starts while it is loaded: it blocks no signals.
    std::thread older([] { std::this_thread::sleep_for(10s); });
    older.detach();
    palpate::block_interrupts();
    kill(getpid(), SIGINT);
    std::this_thread::sleep_for(50ms);
    return palpate::wait_for_interrupt(100ms) ? 0 : 1;
  });
  CHECK(code == 0);
}

TEST_CASE("without a signal, waiting ends at the timeout", "[threads]") {
  const int code = in_child([] {
    palpate::block_interrupts();
    return palpate::wait_for_interrupt(10ms) || palpate::take_rearm_request() ? 1 : 0;
  });
  CHECK(code == 0);
}
