#pragma once
#include <string>
#include <vector>

#include "protocol/endpoint.h"

namespace palpate::client {

/// Returns what about this machine and its way to `local` (its own address on that way) may make a link or a
/// loop worse than necessary. Each is one sentence that says what to change: the processor's governor, no
/// real-time priority, locked memory, a wireless interface, a second interface in the same network. Queries
/// the system only.
std::vector<std::string> link_causes(const protocol::Endpoint& local);

/// Returns those causes that concern the machine alone.
std::vector<std::string> machine_causes();

}  // namespace palpate::client
