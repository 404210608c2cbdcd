#pragma once
#include "common/doorbell.h"
#include "sim_server/serving/page_mailboxes.h"
#include "sim_server/viewer/feed.h"

namespace palpate::sim {

/// What joins the page's thread to the network thread: peers and the telemetry of clients into `feed`, where
/// a mouse points out of it. `began`: time 0 of what is shown. All references outlive what this returns.
ViewerFeed::Hooks page_hooks(ViewerFeed& feed, std::size_t tools, PageMailboxes& mailboxes, Doorbell& bell,
                             Time began);

}  // namespace palpate::sim
