#include "haptic_client/session/link_figures.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;
using protocol::ForceSample;

TEST_CASE("link figures: the stiffness is that into the surface, of samples in contact only") {
  LinkFigures figures;
  ForceSample sample{.number = 1, .tool_t_ns = 1'000'000};
  sample.flags = ForceSample::kHasTangent | ForceSample::kInContact;
  sample.at_tool.tangent << -100, -20, 0, -20, -300, 0, 0, 0, -50;
  sample.at_tool.normal_W = {0.6, 0.8, 0};
  figures.sample(sample, 3ms);
  // n.Kn = 0.36 * 100 + 2 * 0.48 * 20 + 0.64 * 300, by hand
  CHECK(figures.stiffest == Approx(36 + 19.2 + 192));
  CHECK(figures.age_ns.max() == 2'000'000);
  sample.at_tool.tangent = -1e6 * Mat3::Identity();
  sample.flags = ForceSample::kHasTangent;
  figures.sample(sample, 4ms);
  CHECK(figures.stiffest == Approx(247.2));
  sample.tool_t_ns = 9'000'000;  // from the future: no age
  figures.sample(sample, 4ms);
  CHECK(figures.age_ns.count() == 2);
  CHECK(figures.samples == 3);
}

TEST_CASE("link figures: gaps are times of more than 100 ms between two samples") {
  LinkFigures figures;
  for (const Time t : {Time{5s}, Time{5100ms}, Time{5201ms}, Time{5701ms}, Time{5734ms}})
    figures.sample({.number = 1}, t);
  CHECK(figures.gaps == 2);
  CHECK(figures.longest_gap == 500ms);
}

TEST_CASE("link figures: bytes of the first second are those within a second of the first") {
  LinkFigures figures;
  figures.received(100, 5s);
  figures.received(50, 5999ms);
  figures.received(30, 6s);
  CHECK(figures.bytes_down == 180);
  CHECK(figures.early_bytes_down == 150);
}

TEST_CASE("link figures: what the server heard is what it told last") {
  LinkFigures figures;
  ForceSample sample{.number = 1};
  sample.flags = ForceSample::kHasUplink;
  sample.uplink = {300, 200};
  figures.sample(sample, 1s);
  figures.sample({.number = 2}, 2s);  // of a server that tells nothing
  CHECK(figures.uplink.came == 300);
  CHECK(figures.uplink.lost == 200);
}

TEST_CASE(
    "link figures: a way drops large datagrams where samples come for 3 s and no page that was requested") {
  const auto after = [](Time seconds, Time requests_every, int pages) {
    LinkFigures figures;
    std::uint64_t number = 0;
    for (Time t = 5s; t <= 5s + seconds; t += 10ms) {
      figures.sample({.number = ++number}, t);
      if (requests_every > 0s && (t - 5s) % requests_every == 0s) figures.requested_pages(t);
      if (pages-- > 0) figures.page();
    }
    return figures.drops_large();
  };
  CHECK(after(3100ms, 10ms, 0));
  CHECK(after(3100ms, 250ms, 0));        // at the level plain
  CHECK_FALSE(after(3000ms, 10ms, 0));   // not yet
  CHECK_FALSE(after(3100ms, 10ms, 12));  // they came, until less than 3 s ago
  CHECK_FALSE(after(3100ms, 0s, 0));     // none is wanted: the law needs none, or nothing is near
  CHECK_FALSE(after(3100ms, 1s, 0));     // too few to say
  LinkFigures silent;                    // nothing comes at all: that is no matter of size
  silent.sample({.number = 1}, 5s);
  for (Time t = 5s; t < 15s; t += 10ms) silent.requested_pages(t);
  CHECK_FALSE(silent.drops_large());
  CHECK_THAT(large_datagrams_text(), Catch::Contains("fragments") && Catch::Contains("mtu 1280"));
}

TEST_CASE("link figures: a way that begins to drop large datagrams after the first pages is named as well") {
  LinkFigures figures;
  std::uint64_t number = 0;
  const auto go_on = [&](Time from, Time to, Time page_every) {
    for (Time t = from; t < to; t += 10ms) {
      figures.sample({.number = ++number}, t);
      figures.requested_pages(t);
      if (page_every > 0s && (t - from) % page_every == 0s) figures.page();
    }
    return figures.drops_large();
  };
  CHECK_FALSE(go_on(5s, 65010ms, 2500ms));  // they come late, but come
  CHECK_FALSE(go_on(65010ms, 68s, 0s));
  CHECK(go_on(68s, 69s, 0s));
  CHECK_FALSE(go_on(69s, 70s, 500ms));  // they come again
}

TEST_CASE("link figures: an outage, or a burst of requests after a rest, is no way that drops large ones") {
  LinkFigures figures;
  std::uint64_t number = 0;
  for (Time t = 5s; t < 15s; t += 10ms) {
    if (t < 5100ms || t > 14900ms) figures.sample({.number = ++number}, t);
    figures.requested_pages(t);
  }
  CHECK_FALSE(figures.drops_large());  // the link was down for 9.8 s
  figures.page();
  figures.requested_pages(15s);  // what it asks for came with the page before
  for (Time t = 15s; t < 75200ms; t += 10ms) {
    figures.sample({.number = ++number}, t);
    if (t >= 75s) figures.requested_pages(t);
  }
  CHECK_FALSE(figures.drops_large());
}
