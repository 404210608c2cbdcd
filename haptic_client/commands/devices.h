#pragma once
#include "common/program.h"

namespace palpate::client {

/// Prints the known devices that are plugged in on stdout, a line each: bus-port path, model, how to select
/// it, access. Where access is missing, prints the udev rule that grants it. Throws `Error` when there is no
/// USB. Returns the exit code: 1 where no device is found.
int print_plugged_in();

/// `haptic_client devices`.
Command devices_command();

}  // namespace palpate::client
