// A whole session in virtual time, interrupted: what a hand on a spring wall feels meanwhile and afterwards.
#include "common/text.h"
#include "haptic_client/device/simulated_operator.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/catch.h"
#include "tests/support/closed_loop.h"
#include "tests/support/linked_pair.h"

using namespace palpate;
using namespace palpate::client;
using Catch::Matchers::WithinRel;

namespace {

constexpr double kWall = 400, kArm = 300, kDepth = 0.007;  // N/m, N/m, m: of where the hand wants to be
constexpr double kRest = kDepth * kWall * kArm / (kWall + kArm);  // N, springs in series
constexpr double kMostNewton = 8, kMostSlew = 2000;               // N, N/s

/// A hand that wants to be `kDepth` below the wall.
struct Pressing {
  explicit Pressing(const test::LinkedPair::Settings& settings, const char* law = "two_tangents")
      : hand({.hand_stiffness = kArm},
             Trajectory({0, 1, 2000}, {{0, 0.001, 0}, {0, -kDepth, 0}, {0, -kDepth, 0}})),
        pipeline(find_row(extrapolators(), law, "law", "test").make(), {},
                 {.max_force = kMostNewton, .max_slew = kMostSlew}, {}, 0.01),
        pair(hand, pipeline, served(), settings) {}

  static test::Served served() {
    auto organ = std::make_shared<test::Server>(test::served(test::wall(kWall)));
    return {.step = [organ, last = std::uint64_t{0}](std::uint64_t session,
                                                     const protocol::ToolState& state) mutable {
      if (std::exchange(last, session) != session) *organ = test::served(test::wall(kWall));
      return organ->step(state);
    }};
  }
  /// Newtons after `seconds` more; nothing ever left the limits.
  double after(double seconds) {
    for (const double end = pair.seconds() + seconds; pair.seconds() < end - 1e-9;) {
      const double newton = pair.tick().f_D.norm();
      most = std::max(most, newton);
      steepest = std::max(steepest, 1000 * std::abs(newton - before));
      before = newton;
    }
    CHECK(most <= kMostNewton);
    CHECK(steepest <= kMostSlew * (1 + 1e-9));
    return before;
  }

  SimulatedOperator hand;
  Pipeline pipeline;
  test::LinkedPair pair;
  double before = 0, most = 0, steepest = 0;
};

protocol::LinkConditions delayed() {
  return {.delay = 0.01};
}

}  // namespace

TEST_CASE(
    "a server that begins anew in mid-session: the force fades, and is back within 1 s and the soft start") {
  const auto key = GENERATE(protocol::Key{}, protocol::Key{.number = 1, .bytes = {7}});
  Pressing pressing({.up = delayed(), .down = delayed(), .key = key});
  CHECK_THAT(pressing.after(4), WithinRel(kRest, 0.01));
  const std::uint64_t session = pressing.pair.client().welcomed() ? 1 : 0;
  CHECK(session == 1);
  pressing.pair.restart_server();
  CHECK_THAT(pressing.after(2.1), WithinRel(kRest, 0.01));
  CHECK(pressing.pipeline.limiter().fault() == Fault::kNone);
}

TEST_CASE("a client's machine that slept, with a clock that slept too or not, has its tool back") {
  const bool clock_goes_on = GENERATE(false, true);
  const double asleep = GENERATE(0.2, 5.0, 600.0);
  Pressing pressing({.up = delayed(), .down = delayed()});
  CHECK_THAT(pressing.after(4), WithinRel(kRest, 0.01));
  pressing.pair.suspend(asleep, clock_goes_on);
  CHECK_THAT(pressing.after(2.6), WithinRel(kRest, 0.01));
  CHECK(pressing.pipeline.limiter().fault() == Fault::kNone);
}

TEST_CASE("a network that is gone for a while: no force from 0.4 s on, all of it 2 s after its return") {
  const double removed = GENERATE(0.6, 3.0, 60.0);
  protocol::LinkConditions link = delayed();
  link.partitions = {{from_seconds(1 + 4), from_seconds(1 + 4 + removed)}};
  Pressing pressing({.up = link, .down = link});
  CHECK_THAT(pressing.after(4), WithinRel(kRest, 0.01));
  CHECK(pressing.after(0.46) == 0);
  CHECK(pressing.after(removed - 0.46) == 0);
  CHECK_THAT(pressing.after(2.1), WithinRel(kRest, 0.01));
}

TEST_CASE("a tenth lost, a tenth overtaken and late, in bursts: once that is over the force is right") {
  const auto seed = GENERATE(range(1, 6));
  const protocol::LinkConditions link{.delay = 0.04,
                                      .jitter = 0.03,
                                      .burst_start = 0.014,
                                      .burst_end = 0.125,
                                      .duplicates = 0.05,
                                      .reordered = 0.1,
                                      .reorder_delay = 0.04,
                                      .corrupted = 0.02};
  Pressing pressing({.up = link, .down = link, .seed = static_cast<std::uint64_t>(seed), .faults_end = 6});
  CHECK(pressing.after(6) <= kMostNewton);
  CHECK_THAT(pressing.after(2.1), WithinRel(kRest, 0.01));
}
