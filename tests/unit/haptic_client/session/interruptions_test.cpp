// A whole session in virtual time, interrupted: what a hand on a spring wall feels meanwhile and afterwards.
#include <random>

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

  test::Served served() {
    auto organ = std::make_shared<test::Server>(test::served(test::wall(kWall)));
    return {.step = [this, organ, last = std::uint64_t{0}](std::uint64_t session,
                                                           const protocol::ToolState& state) mutable {
      if (std::exchange(last, session) != session) *organ = test::served(test::wall(kWall));
      const auto sample = organ->step(state);
      if (sample) answer = *sample;
      return sample;
    }};
  }
  /// Newtons after `seconds` more; nothing ever left the limits.
  double after(double seconds) {
    for (const double end = pair.seconds() + seconds; pair.seconds() < end - 1e-9;) {
      const TickResult result = pair.tick();
      const double newton = result.f_D.norm();
      if (result.gain < 1 && result.gain <= gain) newest_away = pair.seconds();
      gain = result.gain;
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
  protocol::ForceSample answer;  // the newest
  test::LinkedPair pair;
  double before = 0, most = 0, steepest = 0;
  double gain = 0, newest_away = 0;  // [0, 1]; s, when the force last faded or was gone
};

/// Says anything in the name of either end, as whoever knows the session can without a key, or a faulty peer
/// with one: up to 40 datagrams within a second, with wild numbers and with such that are a little ahead.
class AnyDatagrams {
 public:
  explicit AnyDatagrams(std::uint64_t seed) : random_(seed) {}

  void say(Pressing& pressing) {
    row_ = number(100);
    const std::uint64_t datagrams = 1 + below(40);
    for (at_ = 0; at_ < datagrams; ++at_) {
      say_one(pressing);
      if (below(4) == 0) pressing.after(1e-3 * static_cast<double>(below(100)));
    }
  }

 private:
  std::uint64_t below(std::uint64_t n) { return random_() % n; }
  std::uint64_t number(std::uint64_t near) {
    switch (below(4)) {
      case 0:
        return near + 1 + below(100);
      case 1:
        return near - std::min(near, below(200));
      case 2:
        return (std::uint64_t{1} << 63) + below(8);
      default:
        return random_();
    }
  }
  void say_one(Pressing& pressing) {
    test::LinkedPair& pair = pressing.pair;
    const protocol::Header newest = pair.newest_of_server();
    const auto ticks = static_cast<std::uint64_t>(1000 * pair.seconds());
    const bool in_a_row = below(2) == 0;
    const std::uint64_t up = in_a_row ? row_ + at_ : number(ticks),
                        down = in_a_row ? row_ + at_ : number(newest.sequence);
    const protocol::Header to_server{newest.session, up}, to_client{newest.session, down};
    const std::int64_t t =
        pressing.answer.tool_t_ns + static_cast<std::int64_t>(below(200'000'000)) - 100'000'000;
    switch (below(10)) {
      case 0:
        return pair.forge_to_server(to_server, protocol::Bye{});
      case 1:
        return pair.forge_to_client(to_client, protocol::Bye{});
      case 2:
        return pair.forge_to_client(to_client,
                                    protocol::Refuse{{}, 0, protocol::RefuseReason::kUnknownSession});
      case 3:
      case 4: {
        const protocol::Hello& hello = pair.newest_hello();
        const std::uint64_t session = below(2) == 0 ? newest.session : 9;
        return pair.forge_to_client(
            {session, down},
            protocol::Welcome{
                .nonce = hello.nonce, .attempt = hello.attempt, .rate_hz = 30, .tool_radius = 0.005});
      }
      case 5:
      case 6:
        return pair.forge_to_server(to_server, protocol::ToolState{.tick = up, .t_ns = t});
      case 7:
        return pair.forge_to_server(to_server, protocol::Telemetry{.t_ns = t});
      default: {
        protocol::ForceSample sample = pressing.answer;
        sample.number = below(2) == 0 ? down : sample.number + 1 + below(100);
        sample.tool_t_ns = t;
        return pair.forge_to_client(to_client, sample);
      }
    }
  }

  std::mt19937_64 random_;
  std::uint64_t row_ = 0, at_ = 0;
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

TEST_CASE(
    "any set of datagrams keeps the force away for 1.1 s after its end at most, and it rises over 1 s") {
  const auto key = GENERATE(protocol::Key{}, protocol::Key{.number = 1, .bytes = {7}});
  AnyDatagrams any(83);
  Pressing pressing({.up = delayed(), .down = delayed(), .key = key});
  CHECK_THAT(pressing.after(4), WithinRel(kRest, 0.01));
  for (int set = 0; set < 300; ++set) {
    CAPTURE(set);
    any.say(pressing);
    const double end = pressing.pair.seconds();
    const double newton = pressing.after(1.1 + Watchdog::kSoftStart + 0.01);
    REQUIRE(pressing.newest_away <= end + 1.1);
    REQUIRE_THAT(newton, WithinRel(kRest, 0.01));
  }
}
