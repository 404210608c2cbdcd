// Samples that the server flags as not settled: one is rendered, but not for long.
#include <algorithm>
#include <tuple>

#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using Catch::Matchers::WithinRel;
using protocol::ForceSample;

namespace {

/// A handle at rest at 1 kHz, and a server that says 2 N 30 times a second.
struct Session {
  Pipeline pipeline{find_row(extrapolators(), "constant", "law", "test").make(), {}, {}, {.enabled = false}};
  std::uint64_t ticks = 0, samples = 0;

  /// Returns the force at the end, N. `flags`: of all samples from now on, the first of them at once.
  double run(int milliseconds, std::uint32_t flags) {
    TickResult result;
    for (int i = 0; i < milliseconds; ++i, ++ticks) {
      const Time t = from_seconds(1 + 1e-3 * static_cast<double>(ticks));
      ForceSample sample{.number = samples + 1, .tool_t_ns = t.count()};
      sample.f_W = {0, 2, 0};
      sample.flags = flags;
      const bool comes = i % 33 == 0;
      samples += comes ? 1 : 0;
      result = pipeline.tick({.t = t, .p_D = Vec3::Zero()}, comes ? &sample : nullptr);
    }
    return result.f_D[1];
  }
};

constexpr std::uint32_t kInsideOut = ForceSample::kFlagged | ForceSample::kInsideOut;

}  // namespace

TEST_CASE("flagged samples: the whole force for 100 ms, then none 100 ms later") {
  Session session;
  CHECK_THAT(session.run(1980, 0), WithinRel(2.0, 1e-3));
  CHECK_THAT(session.run(100, kInsideOut), WithinRel(2.0, 1e-3));
  CHECK_FALSE(session.pipeline.doubt());
  const double half = session.run(50, kInsideOut);  // damped by nothing, as the hand rests
  CHECK(half > 0.8);
  CHECK(half < 1.2);
  CHECK(session.pipeline.doubt() == Doubt::kInsideOut);
  CHECK(session.run(60, kInsideOut) == 0);
  CHECK(session.run(1000, kInsideOut) == 0);
  CHECK(session.pipeline.watchdog().ramped() == 1);
  CHECK(session.pipeline.stats().flagged == session.samples - 60);
  CHECK(session.pipeline.stats().unsettled > 1000);
}

TEST_CASE("settled again: a soft start over 1 s") {
  Session session;
  session.run(1980, 0);
  session.run(990, kInsideOut);
  const double half = session.run(500, 0);
  CHECK_FALSE(session.pipeline.doubt());
  CHECK_THAT(half, WithinRel(1.0, 0.02));
  CHECK_THAT(session.run(600, 0), WithinRel(2.0, 1e-3));
}

TEST_CASE("a flagged sample among settled ones fades nothing") {
  Session session;
  session.run(1980, 0);
  for (int i = 0; i < 20; ++i) {
    CHECK_THAT(session.run(33, kInsideOut), WithinRel(2.0, 1e-3));
    CHECK_THAT(session.run(66, 0), WithinRel(2.0, 1e-3));
  }
  CHECK_THAT(session.run(66, kInsideOut), WithinRel(2.0, 1e-3));  // and two in a row
  CHECK_THAT(session.run(33, 0), WithinRel(2.0, 1e-3));
  CHECK(session.pipeline.watchdog().ramped() == 0);
}

TEST_CASE("samples of which more than a third are flagged fade the force, in whatever order they come") {
  // ms, and the round in which flagged - settled / 2 of each before, and its own flagged time, are 100 ms.
  const auto [flagged, settled, round] =
      GENERATE(std::tuple(66, 33, 2), std::tuple(33, 33, 6), std::tuple(66, 99, 4), std::tuple(99, 66, 2));
  Session session;
  session.run(1980, 0);
  double largest = 0;
  for (int i = 1; i < 100; ++i) {
    const double in_doubt = session.run(flagged, kInsideOut);
    CHECK((session.pipeline.watchdog().ramped() > 0) == (i >= round));
    const bool told = session.pipeline.doubt() == Doubt::kInsideOut;
    CHECK(told == (i >= round));
    const double after = session.run(settled, 0);
    CHECK(session.pipeline.doubt().has_value() == told);  // told once, not each time
    if (i >= 80) largest = std::max({largest, in_doubt, after});
  }
  // It rises while samples are settled, and for half as long in the flagged ones after them.
  CHECK(largest <= 2 * 1.5e-3 * settled / Watchdog::kSoftStart);
}

TEST_CASE("the reason of a flagged force that fades is that of the newest sample") {
  for (const Doubt doubt : {Doubt::kFailed, Doubt::kRanAway, Doubt::kInsideOut, Doubt::kNotBalanced,
                            Doubt::kTools, Doubt::kContact, Doubt::kOutsideReach}) {
    Session session;
    session.run(330, ForceSample::kFlagged | ForceSample::kFailed << static_cast<unsigned>(doubt));
    CHECK(session.pipeline.doubt() == doubt);
  }
}
