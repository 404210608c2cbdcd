#pragma once
#include "common/report.h"
#include "protocol/link_stats.h"

namespace palpate::protocol {

/// The counters of one end of a link, for the report of a run that has ended; `rejected_by` names reasons
/// that occurred only.
Json link_report(const LinkStats& stats);

}  // namespace palpate::protocol
