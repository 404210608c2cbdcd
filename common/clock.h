#pragma once
/// The only file that asks the machine what time it is, and the only one that sleeps.
#include "common/time.h"

struct timespec;

namespace palpate {

/// Monotonic time of this machine (CLOCK_MONOTONIC). Any thread, no allocation, about 25 ns.
Time now() noexcept;

/// Processor time that this thread has used (CLOCK_THREAD_CPUTIME_ID), for measurements on busy machines. No
/// allocation, some 200 ns.
Time thread_time() noexcept;

/// Returns the offset from the monotonic clock to the calendar: add it to `now()` for nanoseconds since 1970
/// (UTC).
Time monotonic_epoch() noexcept;

/// A time as calls of the system have it.
Time from_timespec(const timespec& t) noexcept;
timespec to_timespec(Time t) noexcept;

/// Sleeps until the absolute monotonic time `deadline`; returns at once when it has passed. Any thread.
void sleep_until(Time deadline) noexcept;

}  // namespace palpate
