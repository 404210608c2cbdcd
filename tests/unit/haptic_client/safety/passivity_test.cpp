#include "haptic_client/safety/passivity.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;

namespace {

constexpr double kTick = 1e-3;      // s
constexpr double kStiffness = 500;  // N/m, of the tissue: a spring along y, free above y = 0
constexpr double kLargest = 8;      // N
const Vec3 kRest = Vec3::Zero();

Vec3 spring(const Vec3& p, double stiffness = kStiffness) {
  return {0, stiffness * std::max(-p[1], 0.0), 0};
}

/// A handle that is led along y, with a sample of the spring each tick, a tick old.
class Bench {
 public:
  explicit Bench(const Passivity::Settings& settings) : passivity(settings) {}

  /// To `y` (m) in that many ticks under the force `law(p)`.
  template <class Law>
  void lead(double y, int ticks, Law law) {
    const double begin = p_[1];
    for (int i = 1; i <= ticks; ++i) {
      const Vec3 before = p_;
      passivity.sampled(t_, p_, spring(p_), kLargest);
      p_[1] = begin + (y - begin) * i / ticks;
      t_ += from_seconds(kTick);
      passivity.moved(t_, p_ - before, surface_v, kTick);
      ruling = passivity.rule(kTick);
      passivity.wrote(law(p_), -ruling.damping * (p_ - before) / kTick);
    }
    passivity.sampled(t_, p_, spring(p_), kLargest);
  }

  Passivity passivity;
  Passivity::Ruling ruling;
  Vec3 surface_v = kRest;

 private:
  Vec3 p_{0, 0.001, 0};
  Time t_ = std::chrono::seconds(1);
};

constexpr Passivity::Settings kNoDamper{.debt = 1e-3, .allowance = 0, .damping = 0};

}  // namespace

TEST_CASE("a spring that is felt as it is owes what sampling and holding a force makes of it, and no more") {
  Bench bench(kNoDamper);
  bench.lead(-0.010, 1000, [](const Vec3& p) { return spring(p); });  // 10 mm in 1 s: 25 mJ are stored
  // Each tick the force of its beginning is held: k dx^2 / 2 of its work is missing, 1000 times.
  const double held = 1000 * kStiffness * 1e-5 * 1e-5 / 2;
  CHECK(bench.passivity.counts().largest_debt_j <= 1.5 * held);
  bench.lead(0.001, 1000, [](const Vec3& p) { return spring(p); });
  CHECK(bench.passivity.counts().largest_debt_j <= 2.5 * held);
  CHECK(bench.passivity.gain() == 1);
}

TEST_CASE("energy from nowhere is owed at once, though the spring stores many times as much") {
  Bench bench(kNoDamper);
  bench.lead(-0.010, 1000, [](const Vec3& p) { return spring(p); });
  const double before = bench.passivity.debt();
  // 5 N are held while the hand gives way by 2 mm: 10 mJ, where the spring gives 25 - 16 = 9 mJ.
  bench.lead(-0.010 + 0.002, 1, [](const Vec3&) { return Vec3(0, 5, 0); });
  CHECK(bench.passivity.debt() - before == Approx(1e-3).epsilon(0.02));
}

TEST_CASE("a law that gives less than the spring owes nothing") {
  Bench bench(kNoDamper);
  bench.lead(-0.010, 500, [](const Vec3& p) { return spring(p); });
  const double before = bench.passivity.counts().largest_debt_j;
  bench.lead(0.001, 500, [](const Vec3& p) { return Vec3(0.5 * spring(p)); });
  CHECK(bench.passivity.counts().largest_debt_j <= before + 1e-6);  // the last whole force is held for a tick
}

TEST_CASE("contact that begins where nothing was compared owes nothing when the hand draws back") {
  Bench bench(kNoDamper);
  bench.lead(-0.010, 1000, [](const Vec3& p) { return spring(p); });
  bench.passivity.restart();  // as in a soft start, after which the motors have all the force
  const double before = bench.passivity.counts().largest_debt_j;
  bench.lead(0.001, 1000, [](const Vec3& p) { return spring(p); });
  CHECK(bench.passivity.counts().largest_debt_j <= before + 1e-4);
}

TEST_CASE("an organ that pushes the hand does its own work") {
  // The surface, and the hand with it, rise by 10 mm under a steady 1 N: 10 mJ, which are the organ's.
  Passivity passivity(kNoDamper);
  Time t = std::chrono::seconds(1);
  Vec3 p = kRest;
  for (int i = 0; i < 1000; ++i) {
    passivity.sampled(t, p, {0, i == 0 ? 0.9 : 1.0, 0}, kLargest);
    t += from_seconds(kTick);
    p[1] += 1e-5;
    passivity.moved(t, {0, 1e-5, 0}, {0, 1e-2, 0}, kTick);
    passivity.rule(kTick);
    passivity.wrote({0, 1, 0}, kRest);
  }
  CHECK(passivity.counts().largest_debt_j < 2e-4);
}

TEST_CASE("damping grows with the debt to its bound, within a tenth of a second, and pays it") {
  Bench bench({.debt = 1e-3, .allowance = 0, .damping = 8});
  const auto twice = [](const Vec3& p) { return Vec3(2 * spring(p)); };  // of what there is, on the way out
  bench.lead(-0.005, 500, [](const Vec3& p) { return spring(p); });
  CHECK(bench.ruling.damping < 0.5);
  double last = bench.ruling.damping;
  for (int i = 1; i <= 50; ++i) {
    bench.lead(-0.005 + i * 1e-4, 1, twice);
    CHECK(std::abs(bench.ruling.damping - last) <= 8 * kTick / 0.1 + 1e-12);
    last = bench.ruling.damping;
  }
  CHECK(last > 3);
  CHECK(last <= 8);
}

namespace {

/// 2 N all the time, to and fro at 0.1 m/s in a free world for 1 s: pure creation. Or none, at rest.
class Creation {
 public:
  void create() {
    double gain = passivity.gain();
    for (int i = 0; i < 1000; ++i) {
      passivity.sampled(t_, kRest, kRest, kLargest);
      tick({0, 1e-4, 0}, {0, 2, 0});
      CHECK(gain - passivity.gain() <= 10 * kTick * gain * 1.01);  // at most ten times its size a second
      gain = passivity.gain();
    }
  }
  void rest(double seconds) {
    for (const Time end = t_ + from_seconds(seconds); t_ < end;) tick(kRest, kRest);
  }

  Passivity passivity{{.debt = 1e-3, .allowance = 0, .damping = 8}};

 private:
  void tick(const Vec3& moved, const Vec3& law) {
    t_ += from_seconds(kTick);
    passivity.moved(t_, moved, kRest, kTick);
    passivity.rule(kTick);
    passivity.wrote(law, kRest);
  }
  Time t_ = std::chrono::seconds(1);
};

/// A handle of 0.2 kg that 2 N press against a wall, whose force is that of its place one or two samples ago.
struct StiffWall {
  Passivity passivity{{}};
  double y = 1e-3, v = 0, fastest = 0;  // m, m/s
  int falls = 0;                        // times that the gain began to fall
  Time t = std::chrono::seconds(1);

  void run(double seconds, double stiffness) {
    fastest = 0;
    double force = 0, sampled = 0;
    bool fell = false;
    for (int i = 0; i < seconds / kTick; ++i) {
      const double before = y, gain = passivity.gain();
      if (i % 33 == 0) {
        force = sampled;
        sampled = stiffness * std::max(-y, 0.0);
        passivity.sampled(t, {0, y, 0}, {0, sampled, 0}, kLargest);
      }
      const Passivity::Ruling ruling = passivity.rule(kTick);
      const double law = std::min(force, kLargest), damper = -ruling.damping * v;
      falls += !fell && ruling.gain < gain ? 1 : 0;
      fell = ruling.gain < gain || (fell && ruling.gain == gain);
      v += kTick / 0.2 * (ruling.gain * law + damper - 2 - 1.0 * v);  // a hand damps by 1 N s/m
      y += kTick * v;
      t += from_seconds(kTick);
      passivity.moved(t, {0, y - before, 0}, kRest, kTick);
      passivity.wrote({0, law, 0}, {0, damper, 0});
      fastest = std::max(fastest, std::abs(v));
    }
  }
};

}  // namespace

TEST_CASE(
    "only a debt that damping cannot hold makes the wall softer, and 95 % are back 2 s after it is paid") {
  Creation bench;
  bench.create();
  CHECK(bench.passivity.gain() < 0.2);
  while (bench.passivity.debt() > 1e-3) bench.rest(0.01);
  bench.rest(2);
  CHECK(bench.passivity.gain() >= 0.95);
}

TEST_CASE("a wall that makes energy again within 20 s recovers more slowly than it fell") {
  Creation bench;
  bench.create();
  bench.rest(5);
  bench.create();
  const double gain = bench.passivity.gain();
  CHECK(gain < 0.2);
  bench.rest(2);
  CHECK(bench.passivity.gain() > gain);
  CHECK(bench.passivity.gain() < gain + 2 * 0.05);
  bench.rest(25);
  bench.create();
  bench.rest(2.5);
  CHECK(bench.passivity.gain() >= 0.95);
}

TEST_CASE("a wall too stiff for its latency stays soft: the quick return happens once") {
  StiffWall wall;
  wall.run(10, 3000);
  CHECK(wall.passivity.gain() < 0.5);
  const double gain = wall.passivity.gain();
  wall.falls = 0;
  wall.run(50, 3000);
  CAPTURE(wall.fastest, wall.falls, gain, wall.passivity.gain());
  CHECK(wall.fastest <
        0.6);  // m/s, of the limit cycle, as where the gain recovers slowly from the first fall on
  CHECK(wall.passivity.gain() < 0.5);
}

TEST_CASE("what is not finite does not spoil the account, and a disabled controller does nothing") {
  Passivity passivity({.enabled = false});
  Time t = std::chrono::seconds(1);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e200}) {
    passivity.wrote({0, bad, 0}, {0, bad, 0});
    passivity.moved(t += from_seconds(kTick), {0, bad, 0}, {bad, 0, 0}, kTick);
    passivity.sampled(t, {0, bad, 0}, {0, bad, 0}, kLargest);
    CHECK(std::isfinite(passivity.debt()));
  }
  CHECK(passivity.rule(kTick).gain == 1);
  CHECK(passivity.rule(kTick).damping == 0);
}
