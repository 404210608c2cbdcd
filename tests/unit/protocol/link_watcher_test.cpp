#include "protocol/link_watcher.h"

#include "tests/support/catch.h"

using namespace palpate::protocol;

TEST_CASE(
    "what a link counted in a second: nothing but what happened, and a late datagram as one less lost") {
  LinkStats before{.sent = 10, .received = 100, .lost = 5};
  LinkStats now = before;
  CHECK(published_since(before, now) == "0 sent, 0 received");
  now.sent = 40, now.received = 1100, now.lost = 3, now.reordered = 2;
  now.rejected_by[static_cast<std::size_t>(Verdict::kTag)] = 7;
  CHECK(published_since(before, now) == "30 sent, 1000 received, -2 lost, 2 reordered, 7 rejected (tag)");
}
