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
        pace.heard(std::max(free - now, Time{}) + delay + both_ways());
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
