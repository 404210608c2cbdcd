#pragma once
#include <array>
#include <atomic>

#include "common/contact/tool.h"
#include "common/latest_value.h"
#include "common/spsc_ring.h"
#include "protocol/endpoint.h"
#include "protocol/messages.h"

namespace palpate::sim {

/// Who holds a tool, and the datagrams of his session so far.
struct PeerCounts {
  bool held = false;
  protocol::Endpoint endpoint{};
  std::uint64_t received = 0, lost = 0;  // datagrams
  std::uint64_t ticks = 0;               // several of them may travel in one
};

/// Between the network thread and the thread that serves pages, of one tool.
struct ToolPageMailboxes {
  SpscRing<protocol::Telemetry> telemetry{32};  // network -> page
  LatestValue<protocol::Pointer> pointer;       // page -> network
  LatestValue<PeerCounts> peer;                 // network -> page, twenty times a second
};

/// Mailboxes between the network thread and the page thread, where pages are served. Ring the bell of
/// `SimMailboxes` when a pointer waits.
struct PageMailboxes {
  std::array<ToolPageMailboxes, kMaxTools> tools;
  std::atomic<bool> requests_telemetry{false};  // while a page is open
};

}  // namespace palpate::sim
