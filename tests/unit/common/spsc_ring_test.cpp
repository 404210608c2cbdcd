#include "common/spsc_ring.h"

#include <thread>

#include "tests/support/catch.h"

using palpate::SpscRing;

TEST_CASE("a ring gives every value once, in order, and refuses when it is full") {
  SpscRing<int> ring(3);  // rounded up to a power of two
  CHECK(ring.capacity() == 4);
  int value = -1;
  CHECK_FALSE(ring.pop(value));
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 4; ++i) CHECK(ring.push(10 * round + i));
    CHECK_FALSE(ring.push(99));
    CHECK(ring.claim() == nullptr);
    for (int i = 0; i < 4; ++i) {
      REQUIRE(ring.pop(value));
      CHECK(value == 10 * round + i);
    }
    CHECK(ring.front() == nullptr);
  }
}

TEST_CASE("between two threads nothing in a ring is torn, lost or overtaken", "[threads]") {
  struct Pair {
    long a = 0, b = 0;
  };
  constexpr long kLast = 200000;
  SpscRing<Pair> ring(64);
  std::jthread writer([&] {
    for (long i = 1; i <= kLast;) i += ring.push({i, -i}) ? 1 : 0;
  });
  bool wrong = false;
  for (long expected = 1; expected <= kLast;) {
    Pair got;
    if (!ring.pop(got)) continue;
    wrong |= got.a != expected || got.b != -expected;
    ++expected;
  }
  CHECK_FALSE(wrong);
}
