// A simulation that is paused: the force fades, the tool stays, and all comes back softly.
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using Catch::Matchers::WithinRel;
using protocol::ForceSample;
using protocol::ToolState;

namespace {

/// A handle that moves at 0.1 m/s, and a server that says 2 N, or that it is paused.
struct Session {
  Pipeline pipeline{find_row(extrapolators(), "constant", "law", "test").make(), {}, {}, {.enabled = false}};
  std::uint64_t ticks = 0, samples = 0;
  TickResult result;
  bool silent = false;  // nothing comes

  void run(double seconds, bool paused) {
    for (const auto end = ticks + static_cast<std::uint64_t>(1000 * seconds); ticks < end;) {
      const double t = 1e-3 * static_cast<double>(++ticks);
      std::optional<ForceSample> sample;
      if (!silent && ticks % (paused ? 100 : 33) == 0) {
        sample = ForceSample{.number = ++samples, .tool_t_ns = from_seconds(1 + t).count()};
        sample->f_W = {0, 2, 0};
        sample->flags = paused ? ForceSample::kPaused : 0U;
      }
      result = pipeline.tick({.t = from_seconds(1 + t), .p_D = {0.1 * t, 0, 0}}, sample ? &*sample : nullptr);
    }
  }
  bool clutched() const { return (result.tool.flags & ToolState::kClutched) != 0; }
};

}  // namespace

TEST_CASE(
    "pause: the force is gone 100 ms after the client hears of it, not at once, and then the clutch is "
    "held") {
  Session session;
  session.run(2.97, false);
  CHECK_THAT(session.result.f_D[1], WithinRel(2.0, 1e-3));
  session.run(0.03, true);  // heard at 3.000 s
  session.run(0.05, true);
  CHECK(session.result.f_D[1] > 0.5);
  CHECK(session.result.f_D[1] < 1.5);
  CHECK_FALSE(session.clutched());
  session.run(0.06, true);
  CHECK(session.result.f_D.norm() == 0);
  CHECK(session.clutched());
  const Vec3 there = session.result.tool.p_W;
  session.run(5, true);
  CHECK((session.result.tool.p_W - there).norm() < 1e-12);
  CHECK(session.result.f_D.norm() == 0);
}

TEST_CASE("pause: when it ends the tool goes on from where it was held, and the force rises over 1 s") {
  Session session;
  session.run(3, false);
  session.run(2, true);
  const Vec3 there = session.result.tool.p_W;
  session.run(0.04, false);
  CHECK_FALSE(session.clutched());
  CHECK((session.result.tool.p_W - there).norm() < 0.1 * 0.04 + 1e-9);
  CHECK(session.result.f_D[1] < 0.1);
  session.run(0.5, false);
  CHECK(session.result.f_D[1] > 0.5);
  CHECK(session.result.f_D[1] < 1.5);
  session.run(0.6, false);
  CHECK_THAT(session.result.f_D[1], WithinRel(2.0, 1e-3));
}

TEST_CASE("pause: it is no age of a force, and a server that is gone meanwhile is missed") {
  Session session;
  session.run(3, false);
  session.run(20, true);
  CHECK(session.pipeline.stats().age_ns.quantile(1) < 135e6);  // until it heard of the pause, and one period
  CHECK(session.pipeline.age_ns() < 101'000'000);
  session.silent = true;
  session.run(1, true);
  CHECK(session.pipeline.age_ns() > 900'000'000);
  CHECK(session.result.f_D.norm() == 0);
  CHECK(session.clutched());
}
