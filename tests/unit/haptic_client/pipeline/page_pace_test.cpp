#include "haptic_client/pipeline/page_pace.h"

#include <deque>
#include <random>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

/// A line of `bytes_per_s` with a queue of `queue` (s), behind a delay; pages of 937 bytes on it, asked for
/// each 8 ms.
struct Line {
  double bytes_per_s;
  Time delay, queue = 200ms, jitter{};  // of each way, even between 0 and this
  PagePace pace{};
  std::deque<std::pair<Time, Time>> on_the_way{};  // asked, arrives
  Time now = 1000s, free = 0s;
  std::uint64_t came = 0, dropped = 0;
  std::mt19937 random{1};
  Time sampled{};
  Time longest_wait{};

  void run(Time span) {
    for (const Time end = now + span; now < end; now += 8ms) {
      std::erase_if(on_the_way, [this](const auto& page) {
        if (page.second > now) return false;
        pace.came(now - page.first);
        ++came;
        return true;
      });
      if (now - sampled >= 32ms) {  // a sample waits as pages do
        pace.heard(std::max(free - now, Time{}) + delay + both_ways(), 0s, now);
        sampled = now;
      }
      const std::size_t pages = pace.allowed(now);
      pace.requested(pages);
      for (std::size_t i = 0; i < pages; ++i) send();
    }
  }
  void send() {
    free = std::max(free, now);
    longest_wait = std::max(longest_wait, free - now);
    if (free - now > queue) {
      ++dropped;
      pace.lost(1);
      return;
    }
    free += from_seconds(937 / bytes_per_s);
    on_the_way.emplace_back(now, free + delay + both_ways());
  }
  Time both_ways() {
    std::uniform_real_distribution<double> one(0, to_seconds(jitter));
    return from_seconds(one(random) + one(random));
  }
};

}  // namespace

TEST_CASE("pages: on a quick link their rate grows to the fastest within a second, whatever its delay") {
  for (const Time delay : {Time{1ms}, Time{80ms}, Time{400ms}}) {
    Line line{.bytes_per_s = 1e8, .delay = delay};
    line.run(1s + delay);
    CHECK(line.pace.rate() == PagePace::kFastest);
    CHECK(line.dropped == 0);
  }
}

TEST_CASE(
    "pages: on a link of 1 Mbit/s they take most of it, lose nothing, and hold samples up by less than 100 "
    "ms") {
  Line line{.bytes_per_s = 125e3, .delay = 5ms};
  line.run(2s);
  line.longest_wait = {};
  line.came = line.dropped = 0;
  line.run(20s);
  CHECK(line.dropped == 0);
  CHECK(line.longest_wait < 100ms);
  CHECK(static_cast<double>(line.came) > 0.5 * 20 * 125e3 / 937);
}

TEST_CASE("pages: jitter of 40 ms each way is no queue: 800 pages come within 5 s on a quick link") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Line line{.bytes_per_s = 1e8, .delay = 5ms, .jitter = 40ms};
    line.random.seed(seed);
    line.run(5s);
    CAPTURE(seed, line.pace.rate());
    CHECK(line.came > 800);
  }
}

TEST_CASE("pages: a queue that they fill is told from jitter, too") {
  Line line{.bytes_per_s = 125e3, .delay = 5ms, .queue = 400ms, .jitter = 20ms};
  line.run(5s);
  line.longest_wait = {};
  line.dropped = 0;
  line.run(20s);
  CHECK(line.dropped == 0);
  CHECK(line.longest_wait < 200ms);
}

TEST_CASE("pages: the patience is three times what the quickest took, 200 ms at least and 2 s at most") {
  PagePace pace{};
  CHECK(pace.patience() == 200ms);
  pace.came(100ms);
  CHECK(pace.patience() == 300ms);
  pace.came(50ms);
  CHECK(pace.patience() == 200ms);
  PagePace slow;
  slow.came(900ms);
  CHECK(slow.patience() == 2s);
}

TEST_CASE(
    "pages: where all are lost the patience doubles up to 2 s, until one comes that was asked for once") {
  PagePace pace{};
  Time now = 1000s;
  pace.allowed(now);
  for (const Time expected : {Time{400ms}, Time{800ms}, Time{1600ms}, Time{2000ms}, Time{2000ms}}) {
    pace.lost(3);
    pace.allowed(now += 100ms);
    CHECK(pace.patience() == expected);
  }
  pace.came(210ms);
  CHECK(pace.patience() == 630ms);
}

TEST_CASE(
    "pages: on a way that has become longer by 100 ms the rate is the fastest again within half a minute") {
  Line line{.bytes_per_s = 1e8, .delay = 5ms};
  line.run(2s);
  REQUIRE(line.pace.rate() == PagePace::kFastest);
  line.delay = 105ms;
  line.run(1s);
  CHECK(line.pace.rate() < 100);  // as if pages queued
  line.run(24s);
  CHECK(line.pace.rate() == PagePace::kFastest);
}

// At 256 kbit/s a page takes 29 ms, and samples of 447 bytes leave room for 20 pages a second. Contact that
// goes on needs a page now and then, and 40 at once where it comes to a new place.
TEST_CASE("pages: a rate that nothing used does not grow, so that many at once fill no queue of 256 kbit/s") {
  PagePace pace{};
  std::deque<std::pair<Time, Time>> on_the_way;  // asked, arrives
  Time free{}, longest_wait{};
  int missing = 0, dropped = 0;
  for (Time now = 1000s; now < 1025s; now += 8ms) {
    while (!on_the_way.empty() && on_the_way.front().second <= now) {
      pace.came(now - on_the_way.front().first);
      on_the_way.pop_front();
    }
    if ((now - 1000s) % 32ms == 0ms) {  // a sample waits as pages do
      free = std::max(free, now);
      longest_wait = std::max(longest_wait, free - now);
      free += from_seconds(447 / 32e3);
      pace.heard(free - now + 20ms, 0s, now);
    }
    if ((now - 1000s) % 400ms == 0ms) ++missing;
    if (now == 1020s) missing += 40;
    const int pages = std::min(missing, static_cast<int>(pace.allowed(now)));
    pace.requested(static_cast<std::size_t>(pages));
    for (int i = 0; i < pages; ++i) {
      free = std::max(free, now);
      if (free - now > 200ms) {
        ++dropped;
        pace.lost(1);
        continue;
      }
      free += from_seconds(937 / 32e3);
      on_the_way.emplace_back(now, free + 20ms);
      --missing;
    }
  }
  CAPTURE(to_seconds(longest_wait), pace.rate());
  CHECK(dropped == 0);
  CHECK(longest_wait < 150ms);
  CHECK(missing < 5);  // 40 came within 5 s
}

TEST_CASE(
    "pages: samples that wait take the rate down, though no page comes that waited, long steps do not") {
  PagePace pace{}, slow_server{};
  Time now = 1000s;
  for (int i = 0; i < 250; ++i, now += 8ms) {
    const Time more = std::max(i - 125, 0) * 2ms;
    pace.heard(20ms + more, 0s, now), pace.allowed(now);
    slow_server.heard(20ms + more, more, now), slow_server.allowed(now);
  }
  CHECK(pace.rate() == PagePace::kSlowest);
  CHECK(slow_server.rate() == 30);
}

TEST_CASE("pages: no more are allowed than the link's level has room for, and what it had stays known") {
  PagePace pace{};
  Time now = 1000s;
  const auto allowed = [&](Time span) {
    std::size_t pages = 0;
    for (const Time end = now + span; now < end; now += 8ms) {
      const std::size_t more = pace.allowed(now);
      pace.requested(more);
      for (std::size_t i = 0; i < more; ++i) pace.came(10ms);
      pages += more;
    }
    return pages;
  };
  allowed(2s);
  REQUIRE(pace.rate() == PagePace::kFastest);
  pace.bound(4);
  pace.requested(pace.allowed(now));
  const std::size_t few = allowed(10s);
  CHECK(few >= 39);
  CHECK(few <= 41);
  pace.bound(0);
  allowed(1s);
  CHECK(allowed(10s) == 0);
  pace.bound(-1);
  CHECK(pace.rate() == PagePace::kFastest);
  CHECK(allowed(1s) > 900);
}

// A rate that only the bound held down says nothing of what the link carries beyond it.
TEST_CASE("pages: a rate that the link's level bounds does not grow meanwhile") {
  PagePace pace{};
  pace.bound(4);
  for (Time now = 1000s; now < 1020s; now += 8ms) {
    const std::size_t pages = pace.allowed(now);
    pace.requested(pages);
    for (std::size_t i = 0; i < pages; ++i) pace.came(10ms);
  }
  pace.bound(-1);
  CHECK(pace.rate() == 30);
}
