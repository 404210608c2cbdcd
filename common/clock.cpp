#include "common/clock.h"

#include <cerrno>
#include <time.h>

namespace palpate {
namespace {
constexpr long kNanosecondsPerSecond = 1'000'000'000;
}

Time now() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return Time{t.tv_sec * kNanosecondsPerSecond + t.tv_nsec};
}

void sleep_until(Time deadline) noexcept {
  const timespec t{deadline.count() / kNanosecondsPerSecond, deadline.count() % kNanosecondsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace palpate
