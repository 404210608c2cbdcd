#pragma once
#include "common/report.h"
#include "haptic_client/client_config.h"
#include "haptic_client/loop/haptic_loop.h"
#include "haptic_client/net_link.h"

namespace palpate::client {

/// Why a force is latched off, in words.
const char* name_of(Fault fault);

/// The figures of a finished run; keys in haptic_client/README.md.
Json make_report(const ClientConfig& config, const HapticLoop& loop, const Pipeline& pipeline,
                 const NetLink& link);

/// The same for people, on stdout.
void print_report(const Json& report);

}  // namespace palpate::client
