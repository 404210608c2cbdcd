#include "protocol/token_bucket.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace std::chrono_literals;

TEST_CASE("a token bucket lets so many pass at once, and so many a second after that") {
  TokenBucket bucket(100, 5);
  int passed = 0;
  for (int i = 0; i < 20; ++i) passed += bucket.take(1000s) ? 1 : 0;
  CHECK(passed == 5);
  passed = 0;
  for (Time t = 1000s; t < 1010s; t += 1ms) passed += bucket.take(t) ? 1 : 0;
  CHECK(passed >= 998);
  CHECK(passed <= 1000);
  CHECK(bucket.take(2000s));
}
