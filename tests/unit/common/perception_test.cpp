#include "common/perception.h"

#include "tests/support/catch.h"

using namespace palpate;
using Catch::Matchers::EndsWith;

TEST_CASE("what a hand can tell: beside the age of a force, with the thresholds of damper and spring") {
  CHECK(beside_the_hand(45.2, " (p99)") ==
        "a hand can tell 10 % of a force, 15 % of a modulus, and a delay of 15 ms in a damper, 36 ms in a "
        "spring; "
        "this force is 45 ms old (p99): late in both");
  CHECK_THAT(beside_the_hand(14.9), EndsWith("15 ms old: late in neither"));
  CHECK_THAT(beside_the_hand(15), EndsWith("15 ms old: late in a damper"));
  CHECK_THAT(beside_the_hand(35.9), EndsWith("36 ms old: late in a damper"));
  CHECK_THAT(beside_the_hand(36), EndsWith("36 ms old: late in both"));
}
