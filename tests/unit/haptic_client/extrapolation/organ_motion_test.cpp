#include "haptic_client/extrapolation/organ_motion.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

Sample moving(Time t, const Vec3& v) {
  Sample sample{.number = 1, .t = t};
  sample.surface_v = v;
  sample.at_tool = Linearisation{};
  return sample;
}

OrganMotion after(std::initializer_list<Sample> samples) {
  OrganMotion motion;
  for (const Sample& sample : samples) motion.update(sample);
  return motion;
}

const Vec3 kSlowConvergence(0.01, -0.02, 0.03), kFaster(0.02, -0.02, 0.01);

}  // namespace

TEST_CASE("organ motion: even acceleration is followed exactly") {
  const Vec3 v(0.01, -0.02, 0), a(0.3, 0.1, -0.2);
  const OrganMotion motion = after({moving(0ms, v - 0.03 * a), moving(30ms, v)});
  CHECK((motion.since_sample(95ms) - (0.065 * v + 0.5 * 0.065 * 0.065 * a)).norm() < 1e-15);
}

TEST_CASE("organ motion: a breath is followed to third order in time") {
  const double amplitude = 0.005, w = 2 * std::numbers::pi / 4, jerk = amplitude * w * w * w;
  const Vec3 along(0.6, 0.8, 0);
  const auto v = [&](double t) { return Vec3(amplitude * w * std::cos(w * t) * along); };
  const double period = 0.03;
  for (double begin = 0.1; begin < 4; begin += 0.1) {
    const OrganMotion motion = after(
        {moving(from_seconds(begin - period), v(begin - period)), moving(from_seconds(begin), v(begin))});
    for (double age = 0; age < 0.115; age += 0.01) {
      const Vec3 right = amplitude * (std::sin(w * (begin + age)) - std::sin(w * begin)) * along;
      const double bound = jerk * (std::pow(age, 3) / 6 + period * age * age / 4);
      CHECK((motion.since_sample(from_seconds(begin + age)) - right).norm() <=
            bound + 1e-11);  // times are whole ns
    }
  }
}

TEST_CASE("organ motion: by its velocity alone after one sample, an outage, or a start afresh") {
  const auto even = [](const OrganMotion& motion, Time t) {
    return motion.since_sample(t) == Vec3(0.04 * kFaster);
  };
  CHECK(OrganMotion().since_sample(1s) == Vec3::Zero());
  CHECK(even(after({moving(1s, kFaster)}), 1040ms));
  CHECK(even(after({moving(1s, kSlowConvergence), moving(1301ms, kFaster)}), 1341ms));
  OrganMotion motion = after({moving(1s, kSlowConvergence)});
  motion.restart();
  motion.update(moving(1030ms, kFaster));
  CHECK(even(motion, 1070ms));
}

TEST_CASE("organ motion: what is too hard for an organ is another place, not an acceleration") {
  const OrganMotion motion = after({moving(1s, kFaster + Vec3(0, 0.7, 0)), moving(1030ms, kFaster)});
  CHECK(motion.since_sample(1070ms) == Vec3(0.04 * kFaster));
}

TEST_CASE("organ motion: at rest it is zero, bit by bit, and where a sample tells nothing of it") {
  CHECK(after({moving(1s, Vec3::Zero()), moving(1030ms, Vec3::Zero())}).since_sample(2s) == Vec3::Zero());
  Sample silent = moving(1030ms, kSlowConvergence);
  silent.at_tool.reset();
  CHECK(after({moving(1s, kSlowConvergence), silent}).since_sample(1070ms) == Vec3::Zero());
  CHECK(after({silent, moving(1060ms, kFaster)}).since_sample(1100ms) == Vec3(0.04 * kFaster));
}

TEST_CASE("organ motion: finite whatever it is told") {
  for (const double implausible : {1e30, std::numeric_limits<double>::infinity(), std::nan("")}) {
    const OrganMotion motion = after({moving(1s, kSlowConvergence), moving(1030ms, {0, implausible, 0}),
                                      moving(1060ms, kSlowConvergence)});
    CHECK(motion.since_sample(Time{1LL << 62}).allFinite());
    CHECK(after({moving(1s, {implausible, 0, 0})}).since_sample(2s) == Vec3::Zero());
  }
}

TEST_CASE("organ motion: what other tools add has no acceleration where one of them has come or gone") {
  const auto pushed = [](Time t, const Vec3& v) {
    Sample sample = moving(t, kSlowConvergence + v);
    sample.others = OtherTools{.v_W = v};
    return sample;
  };
  const auto ahead = [](const OrganMotion& motion) { return motion.since_sample(70ms); };  // 40 ms on
  const Vec3 v(0, -0.01, 0);
  CHECK((ahead(after({pushed(0ms, Vec3::Zero()), pushed(30ms, v)})) - 0.04 * (kSlowConvergence + v)).norm() <
        1e-15);
  CHECK((ahead(after({pushed(0ms, v), pushed(30ms, Vec3::Zero())})) - 0.04 * kSlowConvergence).norm() <
        1e-15);
  const Vec3 faster = 1.5 * v;  // the same tools, faster: followed as the supports are
  const Vec3 right = 0.04 * (kSlowConvergence + faster) + 0.5 * 0.04 * 0.04 * (faster - v) / 0.03;
  CHECK((ahead(after({pushed(0ms, v), pushed(30ms, faster)})) - right).norm() < 1e-15);
}
