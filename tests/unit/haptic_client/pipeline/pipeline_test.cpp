#include "haptic_client/pipeline/pipeline.h"

#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;
using protocol::ForceSample;
using namespace std::chrono_literals;

namespace {

constexpr Time kTick = 2ms;

Pipeline make(std::size_t law = 0, const Workspace& workspace = {}) {
  return {extrapolators()[law].make(), workspace, {.max_force = 3, .max_slew = 500}};
}

ForceSample sample_at(std::uint64_t number, Time t, const Vec3& p, const Vec3& f) {
  return {.number = number, .tool_t_ns = t.count(), .p_W = p, .f_W = f};
}

/// Runs ticks with a fresh sample of force `f` every 33 ms until the soft start is over.
Time warm_up(Pipeline& pipeline, const Vec3& f) {
  Time t = 1s;
  std::uint64_t number = 0;
  for (int tick = 0; tick < 600; ++tick, t += kTick) {
    const ForceSample sample = sample_at(++number, t, {0, 0, 0}, f);
    pipeline.tick({.t = t}, tick % 16 == 0 ? &sample : nullptr);
  }
  return t;
}

}  // namespace

TEST_CASE("no sample, no force") {
  Pipeline pipeline = make();
  for (int tick = 0; tick < 10; ++tick)
    CHECK(pipeline.tick({.t = tick * kTick}, nullptr).f_D == Vec3::Zero());
}

TEST_CASE("after the soft start the sample's force comes through, the workspace turns it into device force") {
  Pipeline plain = make();
  const Time t = warm_up(plain, {0, 1, 0});
  CHECK((plain.tick({.t = t}, nullptr).f_D - Vec3(0, 1, 0)).norm() < 1e-12);
  Pipeline scaled = make(0, {.scale = 2, .offset_W = {0.1, 0, 0}});
  warm_up(scaled, {0, 1, 0});
  const TickResult result = scaled.tick({.t = t, .p_D = {0.01, 0, 0}}, nullptr);
  CHECK((result.f_D - Vec3(0, 2, 0)).norm() < 1e-12);
  CHECK((result.tool.p_W - Vec3(0.12, 0, 0)).norm() < 1e-15);
}

TEST_CASE(
    "the orientation of a device comes to the world through the axes of the workspace, without one it "
    "stays") {
  Mat3 axes;
  axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // a quarter turn about x
  Pipeline pipeline = make(0, {.axes = axes});
  using Turned = std::array<double, 4>;
  CHECK(pipeline.sense({.t = 1s}).q_W == Turned{1, 0, 0, 0});
  const Turned q = pipeline.sense({.t = 2s, .q_D = Quat(0, 0, 1, 0)}).q_W;  // its z axis to -z, then to y
  CHECK((Quat(q[0], q[1], q[2], q[3]) * Vec3::UnitZ() - Vec3::UnitY()).norm() < 1e-15);
}

TEST_CASE("exactly zero out of contact, for every law, though they look back at a contact") {
  for (std::size_t law = 0; law < extrapolators().size(); ++law) {
    Pipeline pipeline = make(law);
    Time t = warm_up(pipeline, {0, 1, 0});
    const ForceSample free = sample_at(900, t, {0, 0.01, 0}, {0, 0, 0});
    pipeline.tick({.t = t, .p_D = {0, 0.01, 0}}, &free);
    TickResult result;
    for (int tick = 1; tick < 5; ++tick)
      result = pipeline.tick({.t = t += kTick, .p_D = {0, 0.012, 0}}, nullptr);
    CHECK(result.f_D == Vec3::Zero());
  }
}

TEST_CASE("the link dies: force is exactly zero 400 ms after the last sample, and comes back softly") {
  Pipeline pipeline = make();
  Time t = warm_up(pipeline, {0, 1, 0});
  const Time last = t;
  const ForceSample newest = sample_at(900, last, {0, 0, 0}, {0, 1, 0});
  pipeline.tick({.t = t}, &newest);
  TickResult result;
  while (t < last + 300ms) result = pipeline.tick({.t = t += kTick}, nullptr);
  CHECK(result.f_D[1] == Approx(1));
  while (t < last + 400ms) result = pipeline.tick({.t = t += kTick}, nullptr);
  CHECK(result.f_D.norm() < 1e-12);
  result = pipeline.tick({.t = t += kTick}, nullptr);
  CHECK(result.f_D == Vec3::Zero());
  const ForceSample back = sample_at(901, t, {0, 0, 0}, {0, 1, 0});
  CHECK(pipeline.tick({.t = t += kTick}, &back).f_D[1] == Approx(0.002));
  CHECK(pipeline.watchdog().ramped() == 1);
}

TEST_CASE("the link dies under a fast hand: what brakes it comes and goes within ticks, not at once") {
  for (const Time back_after : {Time{350ms}, Time{500ms}}) {
    Pipeline pipeline = make();
    Time t = warm_up(pipeline, {0, 0, 0});
    const Time last = t;
    const double speed = 0.4;  // m/s
    Vec3 p = Vec3::Zero(), before = Vec3::Zero();
    double largest = 0, brake = 0;
    std::uint64_t number = 900;
    while (t < last + 600ms) {
      t += kTick;
      p[0] += speed * to_seconds(kTick);
      ForceSample sample = sample_at(++number, t, p, {0, 0, 0});
      const bool arrives = t - last > back_after;
      const TickResult result = pipeline.tick({.t = t, .p_D = p}, arrives ? &sample : nullptr);
      largest = std::max(largest, (result.f_D - before).norm());
      brake = std::max(brake, -result.f_D[0]);
      before = result.f_D;
    }
    CHECK(brake > 0.2);
    CHECK(largest < 0.08);
    CHECK(before == Vec3::Zero());
  }
}

TEST_CASE("a force beyond the limit is clamped and counted, also while it fades in") {
  Pipeline pipeline = make();
  const Time t = warm_up(pipeline, {0, 100, 0});
  CHECK((pipeline.tick({.t = t}, nullptr).f_D - Vec3(0, 3, 0)).norm() < 1e-12);
  CHECK(pipeline.limiter().counts().clamped == 601);
}

TEST_CASE("after an outage the laws do not draw a line from before it") {
  Pipeline pipeline = make(2);  // linear in position
  Time t = warm_up(pipeline, {0, 0.5, 0});
  t += 1s;
  // Two samples 1 um and one second apart: the old line would have a slope of 1 N per um.
  const ForceSample back = sample_at(901, t, {0, 1e-6, 0}, {0, 1.5, 0});
  pipeline.tick({.t = t}, nullptr);
  Vec3 last = Vec3::Zero();
  for (int tick = 0; tick < 20; ++tick) {
    const Vec3 f =
        pipeline.tick({.t = t += kTick, .p_D = {0, 0.001 * tick, 0}}, tick == 0 ? &back : nullptr).f_D;
    CHECK(f.norm() <= 1.5 * 0.002 * (tick + 1) + 1e-12);
    last = f;
  }
  CHECK(last.norm() > 0);
}

TEST_CASE("a server that begins anew, at once, is met as after an outage: no line from before, and softly") {
  Pipeline pipeline = make(2);  // linear in position
  Time t = warm_up(pipeline, {0, 0.5, 0});
  REQUIRE(pipeline.tick({.t = t}, nullptr).f_D.norm() == Approx(0.5));
  // Its first samples, of another organ, 20 ms after the last of the one before.
  for (std::uint64_t number = 1; number <= 2; ++number) {
    t += 10ms;
    const ForceSample fresh = sample_at(number, t, {0, 1e-6 * static_cast<double>(number), 0}, {0, 1.5, 0});
    const Vec3 f = pipeline.tick({.t = t}, &fresh).f_D;
    CHECK(f.norm() <= 1.5 * 0.020 + 1e-12);  // of a soft start of 1 s
  }
  CHECK(pipeline.stats().overtaken == 0);
}

TEST_CASE("duplicates and latecomers do not reach the law") {
  // Linear in time: two equal times would divide by zero. The other one gets none of them.
  Pipeline pipeline = make(1), undisturbed = make(1);
  Time t = warm_up(pipeline, {0, 1, 0});
  warm_up(undisturbed, {0, 1, 0});
  const ForceSample newest = sample_at(900, t, {0, 0, 0}, {0, 1.5, 0}),
                    late = sample_at(899, t - 5ms, {0, 0, 0}, {0, 9, 0}),
                    future = sample_at(901, t + 1s, {0, 0, 0}, {0, 9, 0});
  pipeline.tick({.t = t}, &newest);
  undisturbed.tick({.t = t}, &newest);
  const auto overtaken = pipeline.stats().overtaken;
  for (const ForceSample* again : {&newest, &late, &future}) {
    t += kTick;
    CHECK(pipeline.tick({.t = t}, again).f_D == undisturbed.tick({.t = t}, nullptr).f_D);
  }
  CHECK(pipeline.stats().overtaken == overtaken + 3);
}

TEST_CASE("a device that gives nothing usable gets no force, and comes back softly by itself") {
  Pipeline pipeline = make();
  Time t = warm_up(pipeline, {0, 1, 0});
  CHECK(pipeline.tick({.t = t, .valid = false}, nullptr).f_D == Vec3::Zero());
  TickResult result = pipeline.tick({.t = t += kTick, .p_D = {std::nan(""), 0, 0}}, nullptr);
  CHECK(result.f_D == Vec3::Zero());
  CHECK((result.tool.flags & protocol::ToolState::kDeviceLost) != 0);
  CHECK(pipeline.limiter().fault() == Fault::kNone);
  CHECK(pipeline.tick({.t = t += kTick}, nullptr).f_D[1] == Approx(0.002));
}

TEST_CASE(
    "clutched, the tool stays where it is and nothing is felt, let go, it moves on from there, softly") {
  Pipeline pipeline = make(0, {.scale = 2, .clutch = 4});
  Time t = warm_up(pipeline, {0, 1, 0});
  const auto tick = [&](double x, std::uint16_t buttons) {
    return pipeline.tick({.t = t += kTick, .p_D = {x, 0, 0}, .buttons = buttons}, nullptr);
  };
  CHECK(tick(0.001, 3).f_D[1] == Approx(2));  // other buttons are no clutch
  for (const double x : {0.002, 0.03, 0.05}) {
    const TickResult held = tick(x, 4);
    CHECK(held.tool.p_W[0] == Approx(0.002));
    CHECK(held.tool.flags == protocol::ToolState::kClutched);
    CHECK(held.f_D == Vec3::Zero());
  }
  // Lost for a tick, while the hand goes on.
  pipeline.tick({.t = t += kTick, .buttons = 4, .valid = false}, nullptr);
  CHECK(tick(0.06, 4).tool.p_W[0] == Approx(0.002));
  const TickResult released = tick(0.061, 0);
  CHECK(released.tool.p_W[0] == Approx(0.004));
  CHECK(released.f_D[1] == Approx(2 * 0.002));  // the first tick of a soft start of one second
}

TEST_CASE("with turned axes the force does the same work in both frames") {
  Mat3 axes;
  axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // world x is the device's z, and so on
  Pipeline pipeline = make(0, {.scale = 2, .offset_W = {0.1, 0, 0}, .axes = axes});
  Time t = warm_up(pipeline, {0.25, 0.5, 1});
  CHECK((pipeline.tick({.t = t}, nullptr).f_D - Vec3(1, 2, 0.5)).norm() < 1e-12);
  const TickResult moved = pipeline.tick({.t = t + kTick, .p_D = {0.01, 0.02, 0.03}}, nullptr);
  CHECK((moved.tool.p_W - Vec3(0.16, 0.02, 0.04)).norm() < 1e-15);
}

TEST_CASE("a device that is found somewhere else did not fly there") {
  Pipeline pipeline = make();
  pipeline.tick({.t = 0ms, .valid = false}, nullptr);
  const TickResult result = pipeline.tick({.t = 2ms, .p_D = {0, 0, 0.11}}, nullptr);
  CHECK(result.tool.v_W == Vec3::Zero());
  CHECK(pipeline.stats().max_speed == 0);
  CHECK(pipeline.stats().path_m == 0);
  pipeline.tick({.t = 4ms, .p_D = {0, 0, 0.111}}, nullptr);
  CHECK(pipeline.stats().path_m == Approx(0.001));
}

TEST_CASE("re-arming disturbs no tool without a fault") {
  Pipeline pipeline = make();
  const Time t = warm_up(pipeline, {0, 1, 0});
  pipeline.rearm();
  CHECK(pipeline.tick({.t = t}, nullptr).f_D[1] == Approx(1));
}

TEST_CASE("re-armed after a fault, the force rises softly") {
  // A force that flips every tick is a storm: it latches off.
  Pipeline pipeline = make();
  Time t = warm_up(pipeline, {0, 1, 0});
  std::uint64_t number = 1000;
  while (pipeline.limiter().fault() == Fault::kNone) {
    t += kTick;
    ++number;
    const ForceSample flip = sample_at(number, t, {0, 0, 0}, {0, number % 2 == 0 ? 3.0 : -3.0, 0});
    pipeline.tick({.t = t}, &flip);
  }
  CHECK(pipeline.limiter().fault() == Fault::kStorm);
  CHECK(pipeline.tick({.t = t += kTick}, nullptr).f_D == Vec3::Zero());
  pipeline.rearm();
  CHECK(pipeline.tick({.t = t += kTick}, nullptr).f_D.norm() == Approx(0.006));
}

TEST_CASE("a tick does not allocate") {
  Pipeline pipeline = make(2);
  const Time t = warm_up(pipeline, {0, 1, 0});
  const ForceSample sample = sample_at(900, t, {0, 0, 0}, {0, 1, 0});
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    pipeline.tick({.t = t}, &sample);
    pipeline.tick({.t = t + kTick}, nullptr);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}

TEST_CASE("what a tick tells the server is enough to feel the same force again, bit by bit") {
  Pipeline live = make(2, {.scale = 1.5, .offset_W = {0.01, 0, 0}}),
           again = make(2, {.scale = 1.5, .offset_W = {0.01, 0, 0}});
  test::Random random(21);
  Time t = 1s;
  bool lost = false;
  for (std::uint64_t tick = 1; tick <= 5000; ++tick) {
    t += Time{static_cast<std::int64_t>(random.between(1.9e6, 2.2e6))};
    if (tick == 3000) t += 700ms;  // an outage: the force fades, the damper brakes
    lost = tick >= 4000 && tick < 4010;
    if (tick == 4300) live.rearm();
    ForceSample sample = sample_at(tick, t - 20ms, random.vector(0.01), random.vector(2));
    const bool fresh = tick % 16 == 0 && !(tick > 2900 && tick < 3000), pause = tick > 2000 && tick < 2200;
    if (pause) sample.flags |= ForceSample::kPaused;
    const DeviceReading reading{.t = t, .p_D = random.vector(0.01), .buttons = 3, .valid = !lost};
    const TickResult rendered = live.tick(reading, fresh ? &sample : nullptr);
    CHECK(rendered.used == (fresh && !pause));
    const TickResult replayed = again.render(rendered.tool, rendered.used ? &sample : nullptr);
    CHECK(replayed.f_D == rendered.f_D);
    CHECK(replayed.tool.newest_sample == rendered.tool.newest_sample);
  }
  CHECK(again.limiter().fault() == Fault::kNone);
  CHECK(again.limiter().counts().slewed == live.limiter().counts().slewed);
}
