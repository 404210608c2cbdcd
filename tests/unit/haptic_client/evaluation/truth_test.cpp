#ifdef PALPATE_WITH_CAPTURE
#include "haptic_client/evaluation/truth.h"

#include <functional>

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/session_capture.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::client;
using protocol::ForceSample;

namespace {

constexpr double kSlope = 10;  // N/s

/// A truth of 1 s at 500 Hz whose force grows by `kSlope`; where it is flagged, a force of 5 N was held.
Truth truth_with(const std::function<bool(std::uint64_t tick)>& flagged) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "truth.pcap";
  test::CaptureOf capture(file);
  for (std::uint64_t tick = 1; tick <= 500; ++tick) {
    const auto t = static_cast<std::int64_t>(tick) * 2'000'000;
    ForceSample sample{.number = tick, .tool_tick = tick, .tool_t_ns = t};
    sample.f_W = {0, kSlope * 1e-9 * static_cast<double>(t), 0};
    if (flagged(tick)) sample.f_W = {0, 5, 0}, sample.flags = ForceSample::kFlagged;
    capture.sample(sample, tick);
    capture.state({.tick = tick, .newest_sample = tick, .t_ns = t}, tick);
  }
  capture.close();
  return Truth(file, [](double) {});
}

}  // namespace

TEST_CASE("truth: beside a flagged sample there is none, between others it is on the line") {
  const Truth truth = truth_with([](std::uint64_t tick) { return tick >= 100 && tick < 110; });
  CHECK(truth.samples() == 500);
  CHECK(truth.flagged() == 10);
  for (const double tick : {50.0, 98.9, 110.1, 499.5}) {
    CAPTURE(tick);
    const auto force = truth.at(from_seconds(0.002 * tick));
    REQUIRE(force);
    CHECK(force->y() == Approx(kSlope * 0.002 * tick));
  }
  for (const double tick : {99.1, 105.0, 109.9}) {
    CAPTURE(tick);
    CHECK_FALSE(truth.at(from_seconds(0.002 * tick)));
    CHECK(truth.distance(Vec3(0, 0, 1), from_seconds(0.002 * tick)) == 1);  // the motion is known there
  }
}

TEST_CASE("truth: one that is flagged for the most part is refused") {
  CHECK(truth_with([](std::uint64_t tick) { return tick % 2 == 0; }).flagged() == 250);
  CHECK_THROWS_WITH(truth_with([](std::uint64_t tick) { return tick % 2 == 0 || tick == 1; }),
                    Catch::Matchers::Contains("251 of its 500 force samples are flagged") &&
                        Catch::Matchers::Contains("record it at a higher --rate"));
}
#endif
