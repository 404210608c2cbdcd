#include "common/clock.h"

#include <cerrno>
#include <ctime>

namespace palpate {

Time from_timespec(const timespec& t) noexcept {
  return std::chrono::seconds(t.tv_sec) + Time{t.tv_nsec};
}

timespec to_timespec(Time t) noexcept {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(t);
  return {.tv_sec = seconds.count(), .tv_nsec = (t - seconds).count()};
}

namespace {
Time read_clock(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return from_timespec(t);
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
  const timespec t = to_timespec(deadline);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace palpate
