#include "protocol/replay_window.h"

#include <algorithm>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/random.h"

using palpate::protocol::LinkStats;
using palpate::protocol::NewestOnly;
using palpate::protocol::ReplayWindow;

TEST_CASE("in order: all received, nothing lost") {
  ReplayWindow window(1000);
  LinkStats stats;
  for (std::uint64_t i = 1; i <= 1000; ++i) CHECK(window.accept(i, stats));
  CHECK(stats.received == 1000);
  CHECK(stats.lost + stats.reordered + stats.duplicated == 0);
}

TEST_CASE("loss, reordering and duplicates are told apart") {
  ReplayWindow window(1000);
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

TEST_CASE("a number far ahead is taken with the fourth in a row, and one alone changes nothing") {
  ReplayWindow window(24);
  LinkStats stats;
  for (std::uint64_t i = 1; i <= 10; ++i) CHECK(window.accept(i, stats));
  CHECK_FALSE(window.accept(std::uint64_t{1} << 62, stats));
  CHECK_FALSE(window.accept(500, stats));
  CHECK(window.accept(11, stats));
  for (const std::uint64_t there : {1000, 1001, 1010}) CHECK_FALSE(window.accept(there, stats));
  CHECK(window.accept(1011, stats));
  CHECK(stats.began_anew == 1);
  CHECK(stats.lost == 0);  // what it says of 1000 datagrams before is not known to be so
  for (std::uint64_t i = 12; i < 30; ++i) CHECK_FALSE(window.accept(i, stats));  // never back
}

TEST_CASE("wild numbers of datagrams and values do not count as lost") {
  ReplayWindow window(24);
  NewestOnly newest;
  LinkStats stats;
  const auto come = [&](std::uint64_t sequence, std::uint64_t number) {
    return window.accept(sequence, stats) && newest.accept(number, sequence, window.in_order(), stats);
  };
  for (std::uint64_t i = 1; i <= 10; ++i) CHECK(come(i, i));
  CHECK(come(13, 60'000));  // two datagrams are missing, so at most two values are
  CHECK(stats.lost == 2);
  CHECK(stats.values_lost == 2);
  constexpr std::uint64_t kWild = std::uint64_t{1} << 63;
  for (std::uint64_t i = 0; i < 4; ++i) come(kWild + i, 60'010);
  CHECK(stats.began_anew == 1);
  CHECK(stats.lost == 2);
  CHECK(stats.values_lost == 2);
}

TEST_CASE("whatever a link does to their order, values that pass the window and are newest only grow") {
  for (const double jitter : {5.0, 20.0, 80.0}) {
    palpate::test::Random random(3);
    std::vector<std::pair<double, std::uint64_t>> arrivals;
    for (std::uint64_t i = 1; i <= 20000; ++i)
      arrivals.emplace_back(static_cast<double>(i) + random.between(0, jitter), i);
    std::ranges::sort(arrivals);
    ReplayWindow window(100);
    NewestOnly newest;
    LinkStats stats;
    std::uint64_t last = 0, passed = 0;
    for (const auto& [t, number] : arrivals) {
      if (!window.accept(number, stats) || !newest.accept(number, number, window.in_order(), stats)) continue;
      CHECK(number > last);
      last = number;
      ++passed;
    }
    CHECK(passed > 400);
    CHECK(passed + stats.overtaken + stats.duplicated + stats.implausible == 20000);
    CHECK(stats.values_lost <= stats.lost);
    if (jitter < 64) CHECK(stats.duplicated == 0);  // later than that is too late to tell
  }
}
