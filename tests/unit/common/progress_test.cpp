#include "common/progress.h"

#include "tests/support/catch.h"

using namespace palpate;

TEST_CASE("time left: in proportion to what is done, in a unit to read, and not before two seconds") {
  CHECK(time_remaining(0.5, from_seconds(1.9)).empty());
  CHECK(time_remaining(0, from_seconds(60)).empty());
  CHECK(time_remaining(1, from_seconds(60)).empty());
  CHECK(time_remaining(0.25, from_seconds(10)) == ", about 30 s left");
  CHECK(time_remaining(0.1, from_seconds(60)) == ", about 9 minutes left");
  CHECK(time_remaining(0.01, from_seconds(360)) == ", about 9.9 hours left");
}
