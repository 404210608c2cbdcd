#include "haptic_client/safety/limiter.h"
#include "haptic_client/safety/rendered_fraction.h"
#include "haptic_client/safety/watchdog.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {
constexpr double kDt = 0.002;
const Vec3 kNone = Vec3::Zero();

/// A tick of the limiter.
Vec3 limit(Limiter& limiter, const Vec3& f_D, double dt = kDt) {
  return limiter.push(limiter.clamp(f_D, dt), dt);
}
}  // namespace

TEST_CASE("a force within the limits passes unchanged") {
  Limiter limiter({.max_force = 8, .max_slew = 160});
  CHECK(limit(limiter, {0.1, -0.2, 0.1}) == Vec3(0.1, -0.2, 0.1));
  CHECK(limiter.counts().clamped + limiter.counts().slewed == 0);
}

TEST_CASE("magnitude is clamped along the direction, change is slewed") {
  Limiter limiter({.max_force = 1, .max_slew = 100});
  Vec3 f = kNone;
  int ticks = 0;
  for (; ticks < 20; ++ticks) {
    const Vec3 next = limit(limiter, {30, 40, 0});
    CHECK((next - f).norm() <= 100 * kDt * (1 + 1e-12));
    f = next;
  }
  CHECK((f - Vec3(0.6, 0.8, 0)).norm() < 1e-12);
  CHECK(limiter.counts().clamped == 20);
  CHECK(limiter.counts().slewed == 4);  // 1 N at 0.2 N a tick: four cut, the fifth arrives
}

TEST_CASE("a stalled loop does not come back with a blow") {
  Limiter limiter({.max_force = 8, .max_slew = 160});
  CHECK(limit(limiter, {8, 0, 0}, 0.2).norm() == Approx(1.6));  // ten milliseconds' worth
  Watchdog watchdog;
  CHECK(watchdog.rule(10ms, false, 0.5).gain == Approx(0.01));
}

TEST_CASE("force goes as slowly as it comes, only losing the device and a fault are quicker") {
  Limiter limiter({.max_force = 8, .max_slew = 100});  // 0.2 N a tick
  for (int tick = 0; tick < 20; ++tick) limit(limiter, {2, 0, 0});
  CHECK(limit(limiter, kNone)[0] == Approx(1.8));
  CHECK(limit(limiter, {0, 2, 0}).norm() < 1.8);
  CHECK(limiter.drop() == kNone);
  CHECK(limit(limiter, {2, 0, 0})[0] == Approx(0.2));
}

TEST_CASE("a share of the largest force is kept along its direction") {
  const Limiter limiter({.max_force = 8});
  CHECK(limiter.within(0.25, {3, 4, 0}).isApprox(Vec3(1.2, 1.6, 0)));
  CHECK(limiter.within(0.25, {0.3, 0.4, 0}) == Vec3(0.3, 0.4, 0));
}

TEST_CASE("less than half of the force for half a second is noticed, shorter, or of a small force, is not") {
  RenderedFraction fraction;
  const auto rendered = [&](double law, double written, double seconds) {
    for (double t = 0; t < seconds - kDt / 2; t += kDt) fraction.tick({0, law, 0}, {0, written, 0}, kDt);
    return fraction.weak();
  };
  CHECK(!rendered(2, 1.01, 5));
  CHECK(!rendered(2, 0.99, 0.498));
  CHECK(rendered(2, 0.99, 0.004));
  CHECK(!rendered(2, 2, kDt));
  CHECK(!rendered(0.19, 0, 5));
  CHECK(rendered(2, -2, 0.6));
  CHECK(fraction.total_s() == Approx(0.502 + 0.6));
  fraction.restart();
  CHECK(!fraction.weak());
}

TEST_CASE("anything at all goes in, and within the limits it comes out") {
  test::Random random(12);
  Limiter limiter({.max_force = 3, .max_slew = 200});
  Vec3 last = kNone;
  const double implausible[] = {0, 1e-320, 1e30, 1e308, -1e308, 5, -0.1};
  for (int tick = 0; tick < 20000; ++tick) {
    Vec3 f = random.vector(10);
    if (tick % 3 == 0) f[tick % 2] = implausible[random.bits() % 7];
    const Vec3 out = limit(limiter, f);
    REQUIRE(out.allFinite());
    REQUIRE(out.norm() <= 3 * (1 + 1e-12));
    REQUIRE((out - last).norm() <= 200 * kDt * (1 + 1e-9) + (limiter.fault() == Fault::kNone ? 0 : 3));
    last = out;
    limiter.rearm();
  }
}

TEST_CASE("a force that is not finite latches until re-armed") {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Limiter limiter({});
    limit(limiter, {0.1, 0, 0});
    CHECK(limit(limiter, {bad, 0, 0}) == kNone);
    CHECK(limiter.fault() == Fault::kNotFinite);
    CHECK(limit(limiter, {0.1, 0, 0}) == kNone);
    CHECK(limiter.counts().not_finite == 1);
    limiter.rearm();
    CHECK(limit(limiter, {0.1, 0, 0}) == Vec3(0.1, 0, 0));
  }
}

TEST_CASE("a storm of slew cuts latches, a long steady clamp does not") {
  Limiter pressed({.max_force = 1, .max_slew = 100}), shaken({.max_force = 1, .max_slew = 100});
  for (int tick = 0; tick < 5000; ++tick) {
    limit(pressed, {5, 0, 0});
    limit(shaken, {tick % 2 == 0 ? 1.0 : -1.0, 0, 0});
  }
  CHECK(pressed.fault() == Fault::kNone);
  CHECK(shaken.fault() == Fault::kStorm);
}

TEST_CASE("one tick that comes late is no storm, however late") {
  Limiter limiter({.max_force = 8, .max_slew = 160});
  for (int tick = 0; tick < 10; ++tick) limit(limiter, kNone);
  limit(limiter, {4, 0, 0}, 1.2);
  for (int tick = 0; tick < 100; ++tick) limit(limiter, {4, 0, 0});
  CHECK(limiter.fault() == Fault::kNone);
}

TEST_CASE("half a second of a force that no tissue makes latches, a shorter one or a stiff wall does not") {
  const double dt = 0.002;
  for (const double size : {799.0, 801.0, 1e9}) {
    Limiter limiter({.max_force = 8, .max_slew = 2000});
    for (int tick = 0; tick < 249; ++tick) limiter.push(limiter.clamp({0, size, 0}, dt), dt);
    CHECK(limiter.fault() == Fault::kNone);
    limiter.push(limiter.clamp({0, 1, 0}, dt), dt);  // once less: it counts from the start
    for (int tick = 0; tick < 252; ++tick) limiter.push(limiter.clamp({0, size, 0}, dt), dt);
    CHECK((limiter.fault() == Fault::kExcessive) == (size > 800));
    CHECK(limiter.counts().implausible == (size > 800 ? 1 : 0));
    if (size < 800) continue;
    CHECK(limiter.push({0, 1, 0}, dt).isZero(0));
    limiter.rearm();
    CHECK_FALSE(limiter.push({0, 1, 0}, dt).isZero(0));
  }
}

TEST_CASE("the ladder: 300 ms, 400 ms, and back over a second") {
  Watchdog watchdog;
  double gain = 0;
  for (int tick = 0; tick < 499; ++tick) gain = watchdog.rule(10ms, false, kDt).gain;
  CHECK(gain == Approx(0.998));
  CHECK(watchdog.rule(10ms, false, kDt).gain == Approx(1));
  CHECK(watchdog.rule(300ms, false, kDt).gain == Approx(1));
  double age_ms = 300;
  Watchdog::Ruling ruling;
  while (age_ms < 399) {
    age_ms += 2;
    ruling = watchdog.rule(from_seconds(age_ms / 1e3), false, kDt);
    if (age_ms < 399) CHECK(ruling.damper);
  }
  CHECK(ruling.gain == Approx(0).margin(1e-12));
  CHECK(watchdog.ramped() == 1);
  CHECK(watchdog.rule(10ms, false, kDt).gain == Approx(kDt));
}

TEST_CASE("no force before there is a sample") {
  Watchdog watchdog;
  for (int tick = 0; tick < 100; ++tick) CHECK(watchdog.rule({}, false, kDt).gain == 0);
  CHECK(watchdog.ramped() == 0);
}
