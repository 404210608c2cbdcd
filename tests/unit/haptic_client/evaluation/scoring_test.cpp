#include "haptic_client/evaluation/scoring.h"

#include <cmath>
#include <map>
#include <numbers>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

constexpr Time kTick = 2ms;
constexpr int kTicksPerSample = 10;

/// A tool that goes along x at 0.1 m/s while the force along y grows by 5 N/s, sampled every 20 ms; samples
/// come `latency` ticks after their tool position.
ErrorSums ramp(Scoring& scoring, int ticks, int latency = 0) {
  ErrorSums sums;
  for (int k = 0; k < ticks; ++k) {
    const Time t = k * kTick;
    const int of = k - latency;  // the tick the arriving sample belongs to
    const double s = to_seconds(of * kTick);
    const Sample sample{
        static_cast<std::uint64_t>(of / kTicksPerSample + 1), of * kTick, {0.1 * s, 0, 0}, {0, 1 + 5 * s, 0}};
    scoring.tick({0.1 * to_seconds(t), 0, 0}, t, of >= 0 && of % kTicksPerSample == 0 ? &sample : nullptr,
                 sums);
  }
  return sums;
}

const std::vector<std::string> kLaws{"constant", "linear_time", "linear_position"};

}  // namespace

TEST_CASE("on a straight ramp without latency, holding errs by a saw tooth and the linear laws by nothing") {
  Scoring scoring(kLaws, 500, "test");
  const ErrorSums sums = ramp(scoring, 501);
  CHECK(scoring.scored() == 500);
  // The saw tooth: 0, 1, .. 9 ticks of 5 N/s * 2 ms; the first interval has no line yet, so all hold there.
  CHECK(sums.error[0] == Approx(50 * 45 * 0.01));
  CHECK(sums.error[1] == Approx(45 * 0.01));
  CHECK(sums.error[2] == Approx(45 * 0.01));
  CHECK(scoring.metrics(0).max_percent == Approx(100 * 0.09 / (1 + 5 * 0.998)));
  CHECK(scoring.metrics(0).jump_percent == Approx(100 * 0.1 / (1 + 5 * 0.998)));
}

TEST_CASE("latency counts: the law is judged with the samples it had") {
  Scoring scoring({"constant"}, 500, "test");
  const int latency = 7;
  const ErrorSums sums = ramp(scoring, 510 + latency, latency);
  // In every interval after the first, the first 7 ticks still hold the sample before: 10 .. 16 ticks off,
  // then 7, 8, 9. In the first interval those 7 ticks knew nothing and are not scored.
  const double late = (10 + 11 + 12 + 13 + 14 + 15 + 16) * 0.01, held = (7 + 8 + 9) * 0.01;
  CHECK(scoring.scored() == 500 - 7);
  CHECK(sums.error[0] == Approx(50 * held + 49 * late));
}

TEST_CASE("each tick is told once, by its number, what it was held against") {
  Scoring scoring({"constant"}, 500, "test");
  std::map<std::uint64_t, Vec3> published;
  const int latency = 7;
  ErrorSums sums;
  for (int k = 0; k < 400; ++k) {
    const int of = k - latency;
    const double s = to_seconds(of * kTick);
    const Sample sample{
        static_cast<std::uint64_t>(of / kTicksPerSample + 1), of * kTick, {s, 0, 0}, {0, 1 + 5 * s, 0}};
    scoring.tick({to_seconds(k * kTick), 0, 0}, k * kTick,
                 of >= 0 && of % kTicksPerSample == 0 ? &sample : nullptr, sums);
    for (const auto& [number, reference] : scoring.newly_scored())
      CHECK(published.emplace(number, reference).second);
  }
  CHECK(published.size() == scoring.scored());
  for (const auto& [number, reference] : published) {
    CHECK(reference.y() == Approx(1 + 5 * to_seconds(static_cast<int>(number) * kTick)));
    CHECK(number < 400 - latency);
  }
}

TEST_CASE("on a closed path a force that comes late creates energy") {
  // x = A sin(w t) on a spring: late by phi, its work in a period is pi k A^2 sin(phi) more; k A^2 goes each
  // way.
  const double w = 2 * std::numbers::pi;
  const auto x = [&](int k) { return Vec3(std::sin(w * to_seconds(k * kTick)), 0, 0); };
  Scoring scoring({"constant"}, 500, "test");
  ErrorSums sums;
  const int late = 10;
  for (int k = 0; k < 2500 + 2 * late; ++k) {  // of which five periods are scored
    const int of = k - late;
    const Sample sample{static_cast<std::uint64_t>(of + 1), of * kTick, x(of), -100 * x(of)};
    scoring.tick(x(k), k * kTick, of >= 0 ? &sample : nullptr, sums);
  }
  CHECK(scoring.energy_percent(0) ==
        Approx(100 * std::numbers::pi * std::sin(w * late * to_seconds(kTick))).epsilon(0.01));
}

TEST_CASE("jumps between samples are counted, whether laws are scored or not, where they have tangents") {
  const auto jumps_of = [](const std::vector<std::string>& laws, bool tangents) {
    Scoring scoring(laws, 500, "test");
    ErrorSums sums;
    for (std::uint64_t n = 1; n <= 10; ++n) {  // a spring of 100 N/m, and from the sixth on 1 N across
      const Time t = static_cast<int>(n) * 10 * kTick;
      const double depth = 0.01 * static_cast<double>(n);
      Sample sample{n, t, {-depth, 0, 0}, {100 * depth, n > 5 ? 1.0 : 0.0, 0}};
      if (tangents)
        sample.at_tool = Linearisation{
            .p_W = sample.p, .f_W = sample.f, .tangent = -100 * Mat3::Identity(), .normal_W = Vec3::UnitX()};
      scoring.tick(sample.p, t, &sample, sums);
    }
    return scoring.unexplained_jumps();
  };
  for (const auto& laws : {std::vector<std::string>{}, kLaws}) {
    REQUIRE(jumps_of(laws, true));
    CHECK(jumps_of(laws, true)->count == 1);
    CHECK(jumps_of(laws, true)->largest_percent == Approx(100 / std::hypot(10, 1)));
    CHECK_FALSE(jumps_of(laws, false));
  }
}

TEST_CASE("nothing is scored across an outage") {
  Scoring scoring({"constant"}, 500, "test");
  ErrorSums sums;
  const Sample first{1, 0s, {0, 0, 0}, {0, 1, 0}}, after{2, 1s, {0, 0, 0}, {0, 5, 0}},
      next{3, 1020ms, {0, 0, 0}, {0, 5, 0}};
  for (int k = 0; k <= 520; ++k) {
    const Sample* arrived = k == 0 ? &first : k == 500 ? &after : k == 510 ? &next : nullptr;
    scoring.tick({0, 0, 0}, k * kTick, arrived, sums);
  }
  CHECK(scoring.scored() == 10);
  CHECK(sums.error[0] == 0);
}

TEST_CASE("an unknown law to score is an error that names the nearest, too many are refused") {
  CHECK_THROWS_WITH(Scoring({"linear_tme"}, 500, "file:3"),
                    Catch::Contains("file:3") && Catch::Contains("linear_time"));
  CHECK_THROWS_WITH(Scoring(std::vector<std::string>(9, "constant"), 500, "file:3"),
                    Catch::Contains("at most 8"));
}

TEST_CASE("scoring does not allocate, however long no sample comes") {
  Scoring scoring(kLaws, 500, "test");
  ErrorSums sums;
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    sums = ramp(scoring, 200);
    for (int k = 200; k < 5000; ++k) scoring.tick({0, 0, 0}, k * kTick, nullptr, sums);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
