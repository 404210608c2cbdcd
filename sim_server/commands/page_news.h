#pragma once
#include "common/doorbell.h"
#include "sim_server/serving/page_mailboxes.h"
#include "sim_server/viewer/feed.h"

namespace palpate::sim {

/// Connects the page's thread to the network thread: peers and the telemetry of clients into `feed`, the
/// position of a mouse out of it. `began`: time 0 of the page. All references outlive the result.
ViewerFeed::Hooks page_hooks(ViewerFeed& feed, std::size_t tools, PageMailboxes& mailboxes, Doorbell& bell,
                             Time began);

}  // namespace palpate::sim
