#pragma once
#include <string>

#include "protocol/endpoint.h"

namespace palpate::sim {

/// Why this address cannot be listened on (TCP), in words; empty: it can. Listens there for a moment.
std::string why_not(const protocol::Endpoint& endpoint);

}  // namespace palpate::sim
