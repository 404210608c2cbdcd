#include "common/clock.h"

#include <cerrno>
#include <time.h>

namespace palpate {
namespace {
constexpr long kNanosecondsPerSecond = 1'000'000'000;

Time read_clock(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return Time{t.tv_sec * kNanosecondsPerSecond + t.tv_nsec};
}

}  // namespace

Time now() noexcept {
  return read_clock(CLOCK_MONOTONIC);
}

Time thread_time() noexcept {
  return read_clock(CLOCK_THREAD_CPUTIME_ID);
}

Time monotonic_epoch() noexcept {
  return read_clock(CLOCK_REALTIME) - now();
}

void sleep_until(Time deadline) noexcept {
  const timespec t{deadline.count() / kNanosecondsPerSecond, deadline.count() % kNanosecondsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace palpate
