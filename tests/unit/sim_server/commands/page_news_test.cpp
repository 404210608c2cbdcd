#include "sim_server/commands/page_news.h"

#include <cmath>
#include <limits>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// A page's feed of one tool.
struct NewsBench {
  std::vector<Vec3> rest = std::vector<Vec3>(3, Vec3::Zero());
  ViewerFeed feed{rest};
  PageMailboxes mailboxes;
  Doorbell bell;
  Time began = std::chrono::seconds(1000);
  ViewerFeed::Hooks hooks = page_hooks(feed, 1, mailboxes, bell, began);
};

}  // namespace

TEST_CASE("page news: ticks have a time of ours, whatever the client's clock says") {
  NewsBench bench;
  ViewerFeed& feed = bench.feed;
  PageMailboxes& mailboxes = bench.mailboxes;
  const ViewerFeed::Hooks& hooks = bench.hooks;
  const Time began = bench.began;
  // Each is far from the one before, so it counts as a clock set anew: its newest tick is of now.
  Time now = began + std::chrono::seconds(5);
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t t_ns : {kLeast, kMost, std::int64_t{0}, kMost, kLeast, std::int64_t{7}, kLeast}) {
    CAPTURE(t_ns);
    protocol::Telemetry published;
    published.t_ns = t_ns;
    published.dt_ns = 2'000'000;
    published.count = 3;
    mailboxes.tools[0].telemetry.push(published);
    feed.ticks.clear();
    hooks.events(now);
    REQUIRE(feed.ticks.size() == 1);
    const ClientTicks& ticks = feed.ticks.front();
    CHECK(ticks.t + 2 * 0.002 == Approx(to_seconds(now - began)).margin(1e-5));
    now += std::chrono::milliseconds(30);
  }
}

TEST_CASE("page news: nothing of a client that left is said of the next") {
  NewsBench bench;
  ViewerFeed& feed = bench.feed;
  PageMailboxes& mailboxes = bench.mailboxes;
  const ViewerFeed::Hooks& hooks = bench.hooks;
  const Time began = bench.began;
  Time now = began;
  const auto report = [&](std::uint8_t named, float error) {
    now += std::chrono::seconds(1);
    protocol::Telemetry published;
    published.t_ns = now.count();
    published.laws = 2;
    published.named = named;
    published.error_percent = error;
    if (named == 4) published.name = {'f', 'a', 'd', 'e', 's'};
    mailboxes.tools[0].telemetry.push(published);
    hooks.events(now);
  };
  const auto hold = [&](bool held) {
    PeerCounts counts;
    counts.held = held;
    mailboxes.tools[0].peer.write(counts);
    hooks.events(now);
  };
  hold(true);
  report(0, 3);
  CHECK(feed.clients[0].errors_percent[0] == 3);
  CHECK(std::isnan(feed.clients[0].errors_percent[1]));  // not told yet
  report(1, 4);
  CHECK(feed.clients[0].errors_percent[1] == 4);
  CHECK(std::isnan(feed.clients[0].parts_percent[0]));
  report(2, 7);  // behind the laws
  CHECK(feed.clients[0].parts_percent[0] == 7);
  report(4, 2);
  CHECK(feed.clients[0].parts_percent[2] == 2);
  CHECK(std::string(feed.clients[0].part_names[2].data()) == "fades");
  report(15, 9);  // more parts than there are: of a client that lies
  CHECK(feed.clients[0].errors_percent[1] == 4);
  hold(false);
  hold(true);
  report(0, 5);
  CHECK(feed.clients[0].errors_percent[0] == 5);
  CHECK(std::isnan(feed.clients[0].errors_percent[1]));
}
