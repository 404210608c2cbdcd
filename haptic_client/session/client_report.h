#pragma once
#include "common/report.h"
#include "haptic_client/evaluation/observation.h"
#include "haptic_client/session/client_config.h"
#include "haptic_client/session/haptic_loop.h"
#include "haptic_client/session/net_link.h"

namespace palpate::client {

/// Why a force is latched off, in words.
const char* name_of(Fault fault);

/// Writes the report of a session, live or replayed, about one tool; keys in session/REPORT.md. Measures the
/// cost of a tick of each scored law, which takes a few milliseconds.
Json tool_report(const ClientConfig& config, const Pipeline& pipeline, const Observation& observation);

/// Writes the part of the report that only a live loop has.
Json loop_report(double rate_hz, const HapticLoopStats& stats);

/// Counters of the link, what it carried, and how old its samples were when they came.
Json link_report(const NetLink& link);

/// A whole report for people, on stdout; parts that are absent are left out.
void print_report(const Json& report);

}  // namespace palpate::client
