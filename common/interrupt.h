#pragma once
#include "common/time.h"

namespace palpate {

/// Keeps Ctrl-C (SIGINT), SIGTERM, SIGHUP, SIGQUIT and SIGUSR1 from ending the program at once: call first in
/// `main`, before any thread starts, so that every thread inherits it. They then arrive only at the calls
/// below. A closed pipe or a full quota (SIGPIPE, SIGXFSZ) becomes an error of the write.
void block_interrupts();

/// Waits up to `timeout` for Ctrl-C, SIGTERM, SIGHUP or SIGQUIT; true when one came. Main thread.
bool wait_for_interrupt(Time timeout);

/// Returns true if SIGUSR1 (the request to re-arm a latched force) came since the last call. Main thread.
bool take_rearm_request();

}  // namespace palpate
