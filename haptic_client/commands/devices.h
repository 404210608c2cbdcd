#pragma once
#include "common/program.h"

namespace palpate::client {

/// What is plugged in and known to us, a line each, on stdout: bus-port path, model, how to ask for it,
/// access; where access is missing, the udev rule that gives it. Throws `Error` when there is no USB. Returns
/// the exit code: 1 where nothing is there.
int print_plugged_in();

/// `haptic_client devices`.
Command devices_command();

}  // namespace palpate::client
