#include "haptic_client/extrapolation/force_estimate.h"

#include <limits>

#include "haptic_client/extrapolation/linear_time.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

/// 1 N, then 2 N, 40 ms apart: linear in time, 25 N/s.
ForceEstimate rising() {
  ForceEstimate estimate(std::make_unique<LinearTime>());
  REQUIRE(estimate.take({1, 0ms, {0, 0, 0}, {0, 1, 0}}, Vec3::Zero(), 1ms));
  REQUIRE(estimate.take({2, 40ms, {0, 0, 0}, {0, 2, 0}}, Vec3::Zero(), 41ms));
  return estimate;
}

}  // namespace

TEST_CASE("time stands still for a law when the newest sample is older than three periods") {
  ForceEstimate estimate = rising();
  CHECK(estimate.force({0, 0, 0}, 160ms)[1] == Approx(5));
  CHECK(estimate.force({0, 0, 0}, 161ms)[1] == Approx(2));
}

TEST_CASE("a sample that is not later, from the future, from before time, or not finite changes nothing") {
  ForceEstimate estimate = rising();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInf = std::numeric_limits<double>::infinity();
  const Time least = Time::min();
  for (const Sample& wrong :
       {Sample{3, 40ms, {0, 0, 0}, {0, 9, 0}}, Sample{3, 39ms, {0, 0, 0}, {0, 9, 0}},
        Sample{3, 90ms, {0, 0, 0}, {0, 9, 0}}, Sample{3, least, {0, 0, 0}, {0, 9, 0}},
        Sample{3, 60ms, {kNan, 0, 0}, {0, 9, 0}}, Sample{3, 60ms, {0, 0, 0}, {0, kInf, 0}}}) {
    CHECK_FALSE(estimate.take(wrong, Vec3::Zero(), 80ms));
    CHECK(estimate.newest().number == 2);
    CHECK(estimate.force({0, 0, 0}, 60ms)[1] == Approx(2.5));
  }
}

TEST_CASE("after an outage a law starts afresh") {
  ForceEstimate estimate = rising();
  REQUIRE(estimate.take({3, 341ms, {0, 0, 0}, {0, 9, 0}}, Vec3::Zero(), 341ms));
  CHECK(estimate.period() == 0ms);
  CHECK(estimate.force({0, 0, 0}, 341ms)[1] == 9);
  REQUIRE(estimate.take({4, 641ms, {0, 0, 0}, {0, 3, 0}}, Vec3::Zero(), 641ms));  // 300 ms: just no outage
  CHECK(estimate.period() == 300ms);
  CHECK(estimate.force({0, 0, 0}, 741ms)[1] == Approx(1));
}

TEST_CASE("a tool that the newest sample saw free feels nothing") {
  ForceEstimate estimate = rising();
  REQUIRE(estimate.take({3, 80ms, {0, 0, 0}, {0, 0, 0}}, Vec3::Zero(), 80ms));
  CHECK(estimate.force({0, 0, 0}, 100ms) == Vec3::Zero());
}
