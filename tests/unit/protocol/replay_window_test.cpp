#include "protocol/replay_window.h"

#include "tests/support/catch.h"

using palpate::protocol::LinkStats;
using palpate::protocol::ReplayWindow;

TEST_CASE("in order: all received, nothing lost") {
  ReplayWindow window;
  LinkStats stats;
  for (std::uint64_t i = 1; i <= 1000; ++i) CHECK(window.accept(i, stats));
  CHECK(stats.received == 1000);
  CHECK(stats.lost + stats.reordered + stats.duplicated == 0);
}

TEST_CASE("loss, reordering and duplicates are told apart") {
  ReplayWindow window;
  LinkStats stats;
  CHECK(window.accept(1, stats));
  CHECK(window.accept(4, stats));
  CHECK(stats.lost == 2);
  CHECK(window.accept(2, stats));
  CHECK(stats.lost == 1);
  CHECK(stats.reordered == 1);
  CHECK_FALSE(window.accept(2, stats));
  CHECK_FALSE(window.accept(4, stats));
  CHECK(stats.duplicated == 2);
  CHECK(window.accept(200, stats));
  CHECK_FALSE(window.accept(136, stats));  // 64 behind: too old to tell
  CHECK(window.accept(137, stats));        // 63 behind: still in the window
  CHECK_FALSE(window.accept(0, stats));
  CHECK(stats.received == 5);
}
