// Error of the force on the hand: what the safety chain and outages take of it, held against closed forms.
#include <cmath>

#include "common/text.h"
#include "haptic_client/evaluation/observation.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;
using Catch::Matchers::WithinRel;

namespace {

constexpr double kRate = 500;
constexpr int kTicksPerSample = 10;

/// A hand at rest under a force of (0, `newton`, 0): a sample every 20 ms from the first tick on, without
/// latency, but where `lost`.
struct Session {
  explicit Session(const std::vector<std::string>& laws = {}, const Workspace& workspace = {})
      : pipeline(find_row(extrapolators(), "constant", "law", "test").make(), workspace, {}),
        observation(laws, kRate, "test", workspace, 0) {}

  bool flags = false;  // the samples from now on

  void tick(double newton, bool lost = false, std::uint16_t buttons = 0) {
    const Time t = 1s + 2ms * ticks;
    std::optional<protocol::ForceSample> sample;
    if (ticks++ % kTicksPerSample == 0 && !lost) {
      sample = protocol::ForceSample{.number = ++samples, .tool_t_ns = t.count()};
      sample->f_W = {0, newton, 0};
      if (flags) sample->flags = protocol::ForceSample::kFlagged | protocol::ForceSample::kNotBalanced;
    }
    observation.tick(pipeline.tick({.t = t, .buttons = buttons}, sample ? &*sample : nullptr), {}, 0);
  }
  void ticks_of(double newton, double seconds, bool lost = false) {
    for (int i = 0; i < seconds * kRate; ++i) tick(newton, lost);
  }
  const RenderedError& rendered() const { return observation.scoring().rendered(); }

  Pipeline pipeline;
  Observation observation;
  int ticks = 0;
  std::uint64_t samples = 0;
};

}  // namespace

TEST_CASE("rendered error: a soft start of 1 s into 1 N costs half a second's worth of it, called a fade") {
  Session session;  // no law is scored
  session.ticks_of(1, 10);
  session.tick(1);
  const RenderedErrorParts parts = session.rendered().parts();
  CHECK(session.rendered().judged() == 5000);
  CHECK(session.observation.scoring().unjudged() == 0);
  CHECK_THAT(parts.hand.mean_percent, WithinRel(100 * 0.5 / 10, 0.01));
  CHECK_THAT(parts.fades_percent, WithinRel(100 * 0.5 / 10, 0.01));
  CHECK(parts.hand.max_of_rms_percent == Approx(100).epsilon(0.01));
  CHECK(parts.extrapolation_percent == 0);
  CHECK(parts.outages_percent == 0);
  CHECK(parts.limits_percent == Approx(0).margin(1e-9));
}

TEST_CASE("rendered error: what the limiter takes of 10 N at 8 N is its own") {
  Session session;
  session.ticks_of(10, 20);
  session.tick(10);
  const RenderedErrorParts parts = session.rendered().parts();
  // 19 s of 2 N; of the first second, gain g: the law's 10 N, faded 10 g, written 8 g.
  CHECK_THAT(parts.limits_percent, WithinRel(100 * (19 * 2 + 0.5 * 2) / (20 * 10), 0.01));
  CHECK_THAT(parts.fades_percent, WithinRel(100 * 0.5 * 10 / (20 * 10), 0.01));
  CHECK_THAT(parts.hand.mean_percent, WithinRel(100 * (19 * 2 + 0.5 * (2 + 10)) / (20 * 10), 0.01));
}

TEST_CASE("rendered error: an outage of 0.6 s is judged by the samples around it") {
  Session session({"constant"});
  session.ticks_of(1, 2);
  const RenderedErrorParts before = session.rendered().parts();
  session.ticks_of(1, 0.6, true);
  for (int i = 0; i < 1500; ++i) session.tick(3);
  // The next sample says 3 N: on the line between, 1 + 2 u; the law held 1 N, faded from 300 ms on.
  const RenderedErrorParts parts = session.rendered().parts();
  const double judged = static_cast<double>(session.rendered().judged()) / kRate;
  const double gap = 0.62;  // from the last sample before to the first after it
  const double squared = 2 - 0.02 + gap * (1 + 2 + 4.0 / 3) + (judged - 1.98 - gap) * 9;
  const double rms = std::sqrt(squared / judged);
  CHECK(parts.outages_percent == Approx(100 * gap / judged / rms).epsilon(0.02));  // mean of 2 u is 1
  CHECK(before.outages_percent == 0);
  CHECK(parts.extrapolation_percent < 0.1);
  const double sum =
      parts.extrapolation_percent + parts.outages_percent + parts.fades_percent + parts.limits_percent;
  CHECK(parts.hand.mean_percent > 0.5 * sum);
  CHECK(parts.hand.mean_percent <= sum * (1 + 1e-12));
  CHECK(session.observation.scoring().metrics(0).max_of_rms_percent < 1e-9);  // a law is not judged there
  CHECK(session.observation.scoring().unjudged() == 0);
}

TEST_CASE("rendered error: ticks that no sample follows soon enough are counted, not judged") {
  Session session;
  session.ticks_of(1, 2);
  session.ticks_of(1, 3, true);
  session.ticks_of(1, 1);
  const auto wait = PastTicks::longest_wait(kRate);
  // The gap begins with the last sample, 10 ticks before the first lost one.
  CHECK(session.observation.scoring().unjudged() == 1500 + 10 - wait);
  CHECK(session.rendered().judged() == 990 + wait + 490);
}

TEST_CASE("rendered error: while the clutch is held no hand is on the tool") {
  const Workspace workspace{.clutch = 1};
  Session session({}, workspace);
  session.ticks_of(1, 1);
  for (int i = 0; i < 500; ++i) session.tick(1, false, 1);
  session.ticks_of(1, 1);
  CHECK(session.rendered().judged() == 500 + 490);
}

TEST_CASE("rendered error: a scaled workspace is no error") {
  Workspace workspace;
  workspace.scale = 2;
  Session session({}, workspace);
  session.ticks_of(1, 10);
  CHECK_THAT(session.rendered().parts().hand.mean_percent, WithinRel(5, 0.01));
}

TEST_CASE("rendered error: a sample that is not settled is no truth, and the ticks beside it are counted") {
  Session session({"constant"});
  session.ticks_of(1, 2);
  const RenderedErrorParts before = session.rendered().parts();
  session.flags = true;
  session.ticks_of(4, 0.06);  // three samples of 4 N
  session.flags = false;
  session.ticks_of(1, 2);
  // From the last settled sample before to the first one after: four intervals of ten ticks.
  CHECK(session.observation.scoring().unsettled() == 40);
  CHECK(session.observation.scoring().unjudged() == 0);
  CHECK(session.rendered().judged() == 1000 - 10 + 1000 - 10);
  CHECK(session.rendered().parts().hand.max_of_rms_percent == Approx(before.hand.max_of_rms_percent));
  CHECK(session.observation.scoring().metrics(0).max_of_rms_percent < 1e-9);
}
