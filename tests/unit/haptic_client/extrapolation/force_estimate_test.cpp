#include "haptic_client/extrapolation/force_estimate.h"

#include <cmath>
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

/// 1 N; a simpler law that stands in for it gives 3 N.
struct StoodInFor : Extrapolator {
  void update(const Sample&) noexcept override {}
  void restart() noexcept override {}
  Vec3 force(const Vec3&, Time) noexcept override { return {0, simpler ? 3.0 : 1.0, 0}; }
  Request request() const noexcept override {
    return {.at_tool = true};
  }  // so that it is asked from the beginning
  bool stepped_down() const noexcept override { return simpler; }
  bool simpler = false;
};
/// From 50 until 80 ms.
struct StoodInForATime : StoodInFor {
  void start_tick(Time now) noexcept override { simpler = now >= 50ms && now < 80ms; }
};
/// From sample 2 until sample 3.
struct StoodInForASample : StoodInFor {
  void update(const Sample& sample) noexcept override { simpler = sample.number == 2; }
};

/// A spring from y = 0 down that is as strong 1 mm below as the newest sample says.
class SampledSpring : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override { newton_ = sample.f[1]; }
  void restart() noexcept override {}
  Vec3 force(const Vec3& p, Time) noexcept override { return {0, newton_ * std::max(-p[1], 0.0) / 1e-3, 0}; }

 private:
  double newton_ = 0;
};

}  // namespace

/// 25 N/s, sampled every 40 ms, samples `latency` old when they arrive; the newest is of 400 ms.
ForceEstimate rising_late(Time latency) {
  ForceEstimate estimate(std::make_unique<LinearTime>());
  for (int i = 0; i <= 10; ++i) {
    const Time t = i * 40ms;
    const Sample sample{static_cast<std::uint64_t>(i + 1), t, {0, 0, 0}, {0, 1 + 25 * to_seconds(t), 0}};
    REQUIRE(estimate.take(sample, Vec3::Zero(), t + latency));
  }
  return estimate;
}

TEST_CASE("samples that are always late are extrapolated in time until they are three periods later still") {
  for (const Time latency : {0ms, 80ms, 150ms}) {
    ForceEstimate estimate = rising_late(latency);
    const Time most = latency + 120ms;
    for (Time age = latency; age <= most; age += 2ms) {
      CAPTURE(latency.count(), age.count());
      CHECK(estimate.force({0, 0, 0}, 400ms + age)[1] == Approx(11 + 25 * to_seconds(age)));
    }
  }
}

TEST_CASE("time turns for a law when no sample comes, runs back as fast as it ran, and stands still") {
  ForceEstimate estimate = rising_late(80ms);
  double before = 11 + 25 * 0.080;
  for (Time age = 80ms; age < 500ms; age += 1ms) {
    CAPTURE(age.count());
    const double given = estimate.force({0, 0, 0}, 400ms + age)[1];
    CHECK(std::abs(given - before) <= 25 * 0.001 * (1 + 1e-9));
    if (age >= 400ms) CHECK(given == Approx(11));
    before = given;
  }
  CHECK(estimate.force({0, 0, 0}, 400ms + 300ms)[1] == Approx(11 + 25 * 0.100));  // 200 ms on, 100 back
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

TEST_CASE("no line leads over a cut: a law starts afresh with the sample that tells of one") {
  ForceEstimate estimate = rising();
  CHECK(estimate.force({0, 0, 0}, 80ms).y() == Approx(3));
  REQUIRE(estimate.take({.number = 3, .t = 80ms, .f = {0, 0.5, 0}, .cuts = 1}, Vec3::Zero(), 81ms));
  CHECK(estimate.force({0, 0, 0}, 120ms).y() == Approx(0.5));
  REQUIRE(estimate.take({.number = 4, .t = 120ms, .f = {0, 1, 0}, .cuts = 1}, Vec3::Zero(), 121ms));
  CHECK(estimate.force({0, 0, 0}, 160ms).y() == Approx(1.5));
}

TEST_CASE("a tool that the newest sample saw free feels nothing") {
  ForceEstimate estimate = rising();
  REQUIRE(estimate.take({3, 80ms, {0, 0, 0}, {0, 0, 0}}, Vec3::Zero(), 80ms));
  CHECK(estimate.force({0, 0, 0}, 100ms) == Vec3::Zero());
}

TEST_CASE("a simpler law that stands in within an interval, and goes again, comes and goes without a jump") {
  constexpr double kBlend = 0.010;
  ForceEstimate estimate(std::make_unique<StoodInForATime>(), kBlend);
  REQUIRE(estimate.take({1, 0ms, {0, 0, 0}, {0, 1, 0}}, Vec3::Zero(), 0ms));
  double before = 1;
  for (Time t = 2ms; t < 150ms; t += 2ms) {
    // From the force given last towards that of the law: e^(-(time since) / blend) of the difference is left.
    const double began = t < 50ms ? 1 : t < 80ms ? 1 : 3 - 2 * std::exp(-0.028 / kBlend);
    const Time since = t < 50ms ? 0ms : t < 80ms ? t - 50ms : t - 80ms;
    const double law = t >= 50ms && t < 80ms ? 3 : 1;
    const double expected = law + (began - law) * std::exp(-to_seconds(since) / kBlend);
    const Vec3 given = estimate.force({0, 0, 0}, t);
    CHECK(given[1] == Approx(expected).epsilon(1e-12));
    if (since == 0ms) CHECK(given[1] == Approx(before).epsilon(1e-12));
    before = given[1];
  }
}

TEST_CASE("a simpler law that begins to stand in with a sample, or leaves with it, does not jump either") {
  constexpr double kBlend = 0.010;
  ForceEstimate estimate(std::make_unique<StoodInForASample>(), kBlend);
  REQUIRE(estimate.take({1, 0ms, {0, 0, 0}, {0, 1, 0}}, Vec3::Zero(), 0ms));
  REQUIRE(estimate.force({0, 0, 0}, 48ms)[1] == Approx(1));
  REQUIRE(estimate.take({2, 40ms, {0, 0, 0}, {0, 1, 0}}, Vec3::Zero(), 50ms));
  CHECK(estimate.force({0, 0, 0}, 50ms)[1] == Approx(1).epsilon(1e-12));
  CHECK(estimate.force({0, 0, 0}, 88ms)[1] == Approx(3 - 2 * std::exp(-3.8)).epsilon(1e-12));
  const double last = 3 - 2 * std::exp(-4.0);  // what it would have been
  REQUIRE(estimate.take({3, 80ms, {0, 0, 0}, {0, 1, 0}}, Vec3::Zero(), 90ms));
  CHECK(estimate.force({0, 0, 0}, 90ms)[1] == Approx(last).epsilon(1e-12));
  CHECK(estimate.force({0, 0, 0}, 100ms)[1] == Approx(1 + (last - 1) * std::exp(-1.0)).epsilon(1e-12));
}

TEST_CASE("without blending a simpler law stands in at once") {
  ForceEstimate estimate(std::make_unique<StoodInForATime>());
  REQUIRE(estimate.take({1, 0ms, {0, 0, 0}, {0, 1, 0}}, Vec3::Zero(), 0ms));
  CHECK(estimate.force({0, 0, 0}, 48ms)[1] == 1);
  CHECK(estimate.force({0, 0, 0}, 50ms)[1] == 3);
  CHECK(estimate.force({0, 0, 0}, 80ms)[1] == 1);
}

TEST_CASE("what is blended in leaves with the force, and is not there when the tool comes back") {
  ForceEstimate estimate(std::make_unique<SampledSpring>(), 0.010);
  const Vec3 deep(0, -1e-3, 0);
  REQUIRE(estimate.take({1, 0ms, deep, {0, 1.5, 0}}, deep, 0ms));
  double before = estimate.force(deep, 33ms)[1];
  REQUIRE(before > 1.4);
  REQUIRE(estimate.take({2, 33ms, deep, {0, 0.5, 0}}, deep, 33ms));
  CHECK(estimate.force(deep, 33ms)[1] == Approx(before));  // nothing jumps
  for (int i = 1; i <= 200; ++i) {                         // out, within 2 ms
    const Vec3 p(0, -1e-3 + 5e-6 * i, 0);
    const double f = estimate.force(p, 33ms + i * Time{10us})[1];
    CHECK(std::abs(f - before) < 0.02);
    before = f;
  }
  CHECK(before == 0);
  CHECK(estimate.force({0, -2e-6, 0}, 36ms)[1] == Approx(0.001));
}

TEST_CASE("what is blended in makes no force pull") {
  ForceEstimate estimate(std::make_unique<SampledSpring>(), 0.010);
  const Vec3 deep(0, -1e-3, 0);
  REQUIRE(estimate.take({1, 0ms, deep, {0, 0.2, 0}}, deep, 0ms));
  double before = estimate.force(deep, 33ms)[1];
  REQUIRE(before > 0.18);
  REQUIRE(estimate.take({2, 33ms, deep, {0, 1.5, 0}}, deep, 33ms));
  CHECK(estimate.force(deep, 33ms)[1] == Approx(before));
  for (int i = 1; i <= 200; ++i) {
    const double f = estimate.force({0, -1e-3 + 5e-6 * i, 0}, 33ms + i * Time{10us})[1];
    CHECK(f > -1e-15);
    CHECK(std::abs(f - before) < 0.02);
    before = f;
  }
}
