#include "haptic_client/session/telemetry_maker.h"

#include <string_view>

#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using protocol::Telemetry;

namespace {

std::string text(const Telemetry::Name& name) {
  return {name.begin(), std::ranges::find(name, std::uint8_t{0})};
}

/// A client that feels a constant force, tick by tick, with two laws beside.
struct Client {
  explicit Client(double ticks_hz)
      : rate_hz(ticks_hz),
        pipeline(find_row(extrapolators(), "constant", "law", "test").make(), {}, {}),
        observation({"constant", "linear_time"}, ticks_hz, "test", Workspace{}, 0),
        maker("falcon", true, "constant", ticks_hz) {}

  /// One tick; samples of (0, `newton`, 0) come at 30 Hz.
  const Telemetry* tick(double newton) {
    const Time t = from_seconds(1 + static_cast<double>(++ticks) / rate_hz);
    std::optional<protocol::ForceSample> sample;
    if (ticks % static_cast<std::uint64_t>(rate_hz / 30) == 0) {
      sample = protocol::ForceSample{.number = ++samples, .tool_t_ns = t.count()};
      sample->f_W = {0, newton, 0};
      sample->flags |= protocol::ForceSample::kHasErrors;
      sample->errors = {{ErrorSource::kMeasured, 30}, {ErrorSource::kNone, 0}};
    }
    const TickResult result = pipeline.tick({.t = t}, sample ? &*sample : nullptr);
    observation.tick(result, Time::zero(), 0);
    return maker.tick(result, pipeline, observation, 7);
  }

  double rate_hz;
  Pipeline pipeline;
  Observation observation;
  TelemetryMaker maker;
  std::uint64_t ticks = 0, samples = 0;
};

}  // namespace

TEST_CASE(
    "telemetry: nothing while nobody wants it, 30 messages a second while somebody does, no tick missing") {
  for (const double rate_hz : {100.0, 500.0, 1000.0, 4000.0}) {
    CAPTURE(rate_hz);
    Client client(rate_hz);
    for (int i = 0; i < 2 * rate_hz; ++i) CHECK(client.tick(1) == nullptr);
    client.maker.want(true);
    std::vector<Telemetry> published;
    for (int i = 0; i < 2 * rate_hz; ++i)
      if (const Telemetry* message = client.tick(1)) published.push_back(*message);
    CHECK(published.size() >= 2 * 30 - 1);
    CHECK(published.size() <= 2 * 34);
    double covered = 0;
    for (const Telemetry& message : published) covered += 1e-9 * message.dt_ns * message.count;
    CHECK_THAT(covered, WithinRel(2.0, 0.04));
    for (std::size_t i = 1; i < published.size(); ++i) {
      const double apart = 1e-9 * static_cast<double>(published[i].t_ns - published[i - 1].t_ns);
      CHECK_THAT(apart, WithinRel(1e-9 * published[i].dt_ns * published[i].count, 1e-6));
    }
    CHECK_THAT(1e9 / published.back().loop.period_ns, WithinRel(rate_hz, 1e-3));
    // The last tick before the next sample sees the oldest one; a message may miss that tick.
    const double oldest = (std::floor(rate_hz / 30) - 1) / rate_hz;
    CHECK_THAT(1e-9 * static_cast<double>(published.back().age_ns), WithinAbs(oldest, 1.01 / rate_hz));
  }
}

TEST_CASE("telemetry: what is felt, by which law, on which device, and the laws beside it by name in turn") {
  Client client(500);
  client.maker.want(true);
  const Telemetry* newest = nullptr;
  std::array<std::string, 8> names;
  std::array<float, 8> errors;
  for (int i = 0; i < 2000; ++i) {
    const Telemetry* message = client.tick(1.5);
    if (message == nullptr) continue;
    names[message->named] = text(message->name);
    errors[message->named] = message->error_percent;
    newest = message;
  }
  REQUIRE(newest != nullptr);
  CHECK(names == std::array<std::string, 8>{"constant", "linear_time", "", "extrapolation", "outages",
                                            "fades", "limits", "worst tick"});
  CHECK_THAT(errors[0], WithinAbs(0, 1e-3));
  // Behind the laws: the mesh, and a soft start of 1 s in the 4 s so far.
  CHECK_THAT(errors[2], WithinRel(30 + 100 * 0.5F / 4, 0.02F));
  CHECK_THAT(errors[3], WithinAbs(0, 1e-3));
  CHECK_THAT(errors[4], WithinAbs(0, 1e-3));
  CHECK_THAT(errors[5], WithinRel(100 * 0.5F / 4, 0.08F));
  CHECK_THAT(errors[6], WithinAbs(0, 1e-3));
  CHECK_THAT(errors[7],
             WithinRel(99.8F, 1e-3F));  // in the first tick of the soft start, 2 ms into its second
  CHECK(text(newest->device) == "falcon");
  CHECK(text(newest->rendered_law) == "constant");
  CHECK(newest->flags == Telemetry::kHasMotors);
  CHECK(newest->loop.missed == 7);
  REQUIRE(newest->laws == 2);
  REQUIRE(newest->count == 16);
  for (std::size_t i = 0; i < newest->count; ++i) {
    CHECK_THAT(newest->rendered[i], WithinRel(1.5F, 1e-4F));
    CHECK_THAT(newest->by_law[2 * i], WithinRel(1.5F, 1e-6F));
  }
  CHECK_THAT(newest->f_W[1], WithinRel(1.5, 1e-4));
}

TEST_CASE("telemetry: the haptic thread allocates nothing for it") {
  Client client(500);
  client.maker.want(true);
  for (int i = 0; i < 100; ++i) client.tick(1);
  std::size_t allocated = 0, messages = 0;
  for (int i = 0; i < 100; ++i) {
    const test::AllocationGuard guard;
    messages += client.tick(1) != nullptr ? 1 : 0;
    allocated += guard.count();
  }
  CHECK(messages >= 5);
  CHECK(allocated == 0);
}
