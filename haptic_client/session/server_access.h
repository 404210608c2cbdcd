#pragma once
#include <string>
#include <system_error>

#include "haptic_client/session/client_config.h"
#include "haptic_client/session/net_link.h"

namespace palpate::client {

/// Usual time limit of a server for its first Welcome.
constexpr Time kWelcomePatience = std::chrono::seconds(5);

/// The server that is asked for; one on another machine only with a key, or where somebody insists. Throws
/// `Error`.
protocol::Endpoint server_of(const ClientConfig& config);

/// The newest key of the file that is named; none without one. Throws `Error`.
protocol::Key key_of(const ClientConfig& config);

/// Returns what helps where the network answers a datagram to a server with this error: what rejects it.
std::string remedy_of(const std::error_code& error);

/// Throws why no server gave a tool within `waited`; `name` begins the sentence about the tool.
[[noreturn]] void fail_unanswered(const NetLink& link, const ClientConfig& config, const std::string& name,
                                  Time waited);

}  // namespace palpate::client
