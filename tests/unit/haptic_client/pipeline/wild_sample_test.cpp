// A single sample with a wild force: what the hand has afterwards.
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using protocol::ForceSample;

namespace {

constexpr double kStiffness = 800, kDepth = 0.003;  // N/m, m

/// A hand that presses by 3 mm into a wall of 800 N/m, swaying by 0.5 mm twice a second; 30 samples a second,
/// 1 kHz.
struct Session {
  explicit Session(const char* law)
      : pipeline(find_row(extrapolators(), law, "law", "test").make(), {}, {}, {}) {}
  Pipeline pipeline;
  std::uint64_t ticks = 0, samples = 0;
  double least = 1e9, most = -1e9;  // N, of `run`

  void run(double seconds, std::optional<double> wild = {}) {
    least = 1e9, most = -1e9;
    for (const auto end = ticks + static_cast<std::uint64_t>(1000 * seconds); ticks < end; ++ticks) {
      const double t = 1e-3 * static_cast<double>(ticks),
                   depth = kDepth + 0.0005 * std::sin(4 * 3.14159265 * t);
      const Time now = from_seconds(1 + t);
      std::optional<ForceSample> sample;
      if (ticks % 33 == 0) {
        sample = ForceSample{.number = ++samples, .tool_t_ns = now.count()};
        sample->p_W = {0, -depth, 0};
        sample->f_W = {0, wild.value_or(kStiffness * depth), 0};
        sample->flags = ForceSample::kInContact | ForceSample::kHasTangent;
        sample->at_tool.tangent(1, 1) = -kStiffness;
        sample->at_tool.normal_W = Vec3::UnitY();
        wild.reset();
      }
      const double f = pipeline.tick({.t = now, .p_D = {0, -depth, 0}}, sample ? &*sample : nullptr).f_D[1];
      least = std::min(least, f);
      most = std::max(most, f);
    }
  }
};

}  // namespace

TEST_CASE(
    "a force of over 100 times the limit is dropped: the hand feels what it would had the sample been lost") {
  for (const char* law : {"constant", "tangent"}) {
    for (const double wild : {-1e9, 1e9, -801.0}) {
      CAPTURE(law, wild);
      Session session(law);
      session.run(3.96);
      const double most = session.most, least = session.least;
      session.run(0.033, wild);
      CHECK(session.least > least - 0.5);  // N: the newest sample is one period older
      CHECK(session.most < most + 0.5);
      session.run(2);
      CHECK(session.pipeline.passivity().gain() == 1);
      CHECK(session.most == Approx(most).epsilon(0.05));
      CHECK(session.pipeline.stats().wild == 1);
      CHECK(session.pipeline.watchdog().ramped() == 0);
    }
  }
}

TEST_CASE("forces of over 100 times the limit, and no others: the force fades as without samples") {
  Session session("constant");
  session.run(3.96);
  for (int i = 0; i < 15; ++i) session.run(0.033, 1e6);
  CHECK(session.least == 0);
  CHECK(session.most == 0);
  session.run(1.5);
  CHECK(session.most > 2);  // back by a soft start
  CHECK(session.pipeline.limiter().fault() == Fault::kNone);
}
