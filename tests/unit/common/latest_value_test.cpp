#include "common/latest_value.h"

#include <thread>

#include "tests/support/catch.h"

using palpate::LatestValue;

TEST_CASE("a mailbox gives the newest value once") {
  LatestValue<int> box;
  int value = -1;
  CHECK_FALSE(box.read(value));
  box.write(1);
  box.write(2);
  CHECK(box.read(value));
  CHECK(value == 2);
  CHECK_FALSE(box.read(value));
  CHECK(value == 2);
}

TEST_CASE("between two threads no value is torn, none comes twice, and the last one arrives", "[threads]") {
  struct Pair {
    long a = 0, b = 0;
  };
  constexpr long kLast = 200000;
  LatestValue<Pair> box;
  std::jthread writer([&] {
    for (long i = 1; i <= kLast; ++i) box.write({i, -i});
  });
  Pair got;
  long before = 0;
  bool torn = false, backwards = false;
  while (got.a < kLast) {
    if (!box.read(got)) continue;
    torn |= got.b != -got.a;
    backwards |= got.a <= before;
    before = got.a;
  }
  CHECK_FALSE(torn);
  CHECK_FALSE(backwards);
}
