#pragma once
#include "common/program.h"
#include "haptic_client/session/client_config.h"

namespace palpate::client {

/// `haptic_client calibrate`: guides the user on the terminal, prints the line for the client file. `config`
/// names a Falcon; `mass`: of the weight, kg. Until Ctrl-C at the latest; throws `Error`, also for that.
/// Returns the exit code.
int calibrate(ClientConfig config, double mass);

/// `haptic_client calibrate`.
Command calibrate_command();

}  // namespace palpate::client
