#include "protocol/link_simulator.h"

#include <algorithm>
#include <cmath>

#include "common/hash.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

struct Arrival {
  Time t;
  std::vector<std::byte> bytes;
  /// Which one it is, written by `run` in its first four bytes.
  int number() const {
    int n = 0;
    for (int i = 3; i >= 0; --i) n = n << 8 | std::to_integer<int>(bytes[static_cast<std::size_t>(i)]);
    return n;
  }
};

std::vector<std::byte> datagram(int number, std::size_t size) {
  std::vector<std::byte> bytes(size, std::byte{0x5a});
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::byte>(number >> (8 * i));
  return bytes;
}

struct Run {
  std::vector<Arrival> arrivals;
  LinkCounts counts;
};

/// `count` datagrams, one each `period`, and what comes out of the other end, at the very time it does.
Run run(const LinkConditions& conditions, int count, Time period = 10ms, std::uint64_t seed = 1,
        std::size_t size = 100) {
  LinkSimulator link(conditions, seed);
  Run run;
  const auto receive = [&](Time until) {
    while (const auto next = link.next_arrival()) {
      if (*next > until) break;
      CHECK_FALSE(link.receive(*next - 1ns));
      run.arrivals.push_back({*next, *link.receive(*next)});
    }
  };
  for (int i = 0; i < count; ++i) {
    receive(i * period);
    link.send(datagram(i, size), i * period);
  }
  receive(Time::max());
  run.counts = link.counts();
  CHECK(run.counts.sent == static_cast<std::uint64_t>(count));
  CHECK(run.counts.delivered == run.arrivals.size());
  return run;
}

std::vector<int> numbers(const Run& run) {
  std::vector<int> all;
  for (const Arrival& arrival : run.arrivals) all.push_back(arrival.number());
  return all;
}

/// Whether `count` of `tries` is what chance `p` gives, within five standard deviations.
bool plausible(std::uint64_t count, double tries, double p) {
  return std::abs(static_cast<double>(count) - tries * p) <= 5 * std::sqrt(tries * p * (1 - p));
}

const LinkConditions kEverything{.delay = 0.02,
                                 .jitter = 0.03,
                                 .loss = 0.05,
                                 .burst_start = 0.01,
                                 .burst_end = 0.25,
                                 .duplicates = 0.1,
                                 .reordered = 0.1,
                                 .reorder_delay = 0.05,
                                 .corrupted = 0.1,
                                 .bandwidth = 20'000,
                                 .delay_steps = {{1s, 0.2}, {2s, 0.01}},
                                 .partitions = {{3s, 3500ms}}};

}  // namespace

TEST_CASE("link simulator: a link without faults is a delay, to the nanosecond, and changes no byte") {
  const Run plain = run({.delay = 0.0125}, 50);
  REQUIRE(plain.arrivals.size() == 50);
  for (int i = 0; i < 50; ++i) {
    CHECK(plain.arrivals[i].t == i * 10ms + 12500us);
    CHECK(plain.arrivals[i].bytes == datagram(i, 100));
  }
}

TEST_CASE("link simulator: jitter is even between nothing and its bound, and lets datagrams overtake") {
  const Run jittered = run({.delay = 0.02, .jitter = 0.03}, 20000);
  double sum = 0, squares = 0, least = 1, most = 0;
  for (const Arrival& arrival : jittered.arrivals) {
    const double late = to_seconds(arrival.t - arrival.number() * 10ms) - 0.02;
    sum += late;
    squares += late * late;
    least = std::min(least, late);
    most = std::max(most, late);
  }
  const double mean = sum / 20000;
  CHECK(least >= 0);
  CHECK(most < 0.03);
  CHECK(mean == Approx(0.015).epsilon(0.02));
  CHECK(std::sqrt(squares / 20000 - mean * mean) == Approx(0.03 / std::sqrt(12)).epsilon(0.02));
  const auto order = numbers(jittered);
  CHECK_FALSE(std::ranges::is_sorted(order));
}

TEST_CASE("link simulator: single losses and bursts have their share, bursts their mean length") {
  constexpr int kCount = 100000;
  const Run single = run({.loss = 0.05}, kCount);
  CHECK(plausible(single.counts.lost, kCount, 0.05));
  CHECK(single.counts.delivered + single.counts.lost == kCount);
  const Run bursts = run({.burst_start = 0.01, .burst_end = 0.25}, kCount);
  const auto at_tool = numbers(bursts);
  int gaps = 0;
  for (std::size_t i = 1; i < at_tool.size(); ++i) gaps += at_tool[i] > at_tool[i - 1] + 1 ? 1 : 0;
  const auto lost = static_cast<double>(bursts.counts.lost_in_bursts);
  CHECK(bursts.counts.lost == 0);
  // One burst may follow another at once: a gap lasts until a burst ends and none begins, on average
  // 1 / (0.25 x 0.99).
  CHECK(lost / gaps == Approx(1 / (0.25 * 0.99)).epsilon(0.1));
  // Of a cycle of 1/0.25 lost and 0.99/0.01 delivered ones, the lost.
  CHECK(lost / kCount == Approx(4.0 / (4 + 99)).epsilon(0.1));
}

TEST_CASE(
    "link simulator: duplicates come twice, held-back ones behind, corrupted ones with one other byte") {
  constexpr int kCount = 20000;
  const Run twice = run({.duplicates = 0.1}, kCount);
  CHECK(plausible(twice.counts.duplicated, kCount, 0.1));
  CHECK(twice.counts.delivered == kCount + twice.counts.duplicated);
  const Run back = run({.delay = 0.01, .reordered = 0.2, .reorder_delay = 0.025}, kCount);
  CHECK(plausible(back.counts.reordered, kCount, 0.2));
  std::uint64_t held = 0;
  for (const Arrival& arrival : back.arrivals) {
    const Time late = arrival.t - arrival.number() * 10ms;
    CHECK((late == 10ms || late == 35ms));
    held += late == 35ms ? 1 : 0;
  }
  CHECK(held == back.counts.reordered);
  const Run wrong = run({.corrupted = 0.3}, kCount);
  CHECK(plausible(wrong.counts.corrupted, kCount, 0.3));
  std::uint64_t differ = 0;
  for (int i = 0; i < kCount; ++i) {
    const auto &got = wrong.arrivals[i].bytes, sent = datagram(i, 100);
    int bytes = 0;
    for (std::size_t b = 0; b < sent.size(); ++b) bytes += got[b] != sent[b] ? 1 : 0;
    CHECK(bytes <= 1);
    differ += static_cast<std::uint64_t>(bytes);
  }
  CHECK(differ == wrong.counts.corrupted);
}

TEST_CASE("link simulator: a narrow line sends one after the other, and drops what would wait too long") {
  // 100 bytes at 1000 bytes/s, five at once, and one when the line is free again.
  LinkSimulator line({.delay = 0.05, .bandwidth = 1000, .queue = 0.25}, 1);
  for (int i = 0; i < 5; ++i) line.send(datagram(i, 100), 0s);
  CHECK(line.counts().dropped_by_queue == 2);  // they would begin after 0.3 s
  line.send(datagram(5, 100), 1s);
  for (const auto& [t, number] : {std::pair{150ms, 0}, {250ms, 1}, {350ms, 2}, {1150ms, 5}}) {
    REQUIRE(line.next_arrival());
    CHECK(*line.next_arrival() == t);
    CHECK(line.receive(t) == datagram(number, 100));
  }
  CHECK_FALSE(line.next_arrival());
}

TEST_CASE("link simulator: the delay steps from 5 to 200 ms and back, and what is sent then overtakes") {
  const Run steps = run({.delay = 0.005, .delay_steps = {{30ms, 0.2}, {60ms, 0.005}}}, 8);
  CHECK(numbers(steps) == std::vector{0, 1, 2, 6, 7, 3, 4, 5});
  CHECK(steps.arrivals[2].t == 25ms);
  CHECK(steps.arrivals[3].t == 65ms);
  CHECK(steps.arrivals[5].t == 230ms);
}

TEST_CASE("link simulator: nothing sent during a partition arrives, what was on its way does") {
  const Run cut = run({.delay = 0.015, .partitions = {{20ms, 40ms}, {60ms, 61ms}}}, 8);
  CHECK(numbers(cut) == std::vector{0, 1, 4, 5, 7});
  CHECK(cut.counts.partitioned == 3);
}

TEST_CASE(
    "link simulator: the same seed gives the same, another another, one fault does not shift the others") {
  const auto hash_of = [](const Run& run) {
    Fnv1a hash;
    for (const Arrival& arrival : run.arrivals) {
      hash.add(&arrival.t, sizeof arrival.t);
      hash.add(arrival.bytes.data(), arrival.bytes.size());
    }
    return hash.value();
  };
  const Run once = run(kEverything, 1000);
  CHECK(hash_of(once) == hash_of(run(kEverything, 1000)));
  CHECK(hash_of(once) != hash_of(run(kEverything, 1000, 10ms, 2)));
  LinkConditions steady = kEverything;
  steady.jitter = 0;
  const Run still = run(steady, 1000);
  CHECK(still.counts.lost == once.counts.lost);
  CHECK(still.counts.lost_in_bursts == once.counts.lost_in_bursts);
  CHECK(still.counts.corrupted == once.counts.corrupted);
  // The same on every machine, as it was on the first: this shows a change, not that it is right.
  CHECK(once.counts.lost == 46);
  CHECK(once.counts.delivered == 937);
  CHECK(hash_of(once) == 0x1882113258875c);
}
