// Laws on sequences worked out by hand.
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolator.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/extrapolation/interpolate_with_delay.h"
#include "haptic_client/extrapolation/kalman.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

std::unique_ptr<Extrapolator> law(const char* name) {
  return find_row(extrapolators(), name, "method", "test").make();
}

/// P goes 0, 2 mm along x while F goes 1, 2 N along y, 40 ms apart.
std::unique_ptr<Extrapolator> after_two_samples(const char* name) {
  auto l = law(name);
  l->update({1, 0ms, {0, 0, 0}, {0, 1, 0}});
  l->update({2, 40ms, {0.002, 0, 0}, {0, 2, 0}});
  return l;
}

}  // namespace

TEST_CASE("constant is exact to the bit") {
  const Vec3 f(0.1, 1.0 / 3, 1e-300);
  auto l = law("constant");
  CHECK(l->force({1, 2, 3}, 5ms) == Vec3::Zero());
  l->update({1, 0ms, {0, 0, 0}, f});
  CHECK(l->force({1, 2, 3}, 500ms) == f);
}

TEST_CASE("linear in time: F_n + (t - t_n) / (t_n - t_(n-1)) (F_n - F_(n-1))") {
  auto l = after_two_samples("linear_time");
  CHECK(l->force({9, 9, 9}, 40ms)[1] == Approx(2));
  CHECK(l->force({9, 9, 9}, 60ms)[1] == Approx(2.5));
  CHECK(l->force({9, 9, 9}, 80ms)[1] == Approx(3));
}

TEST_CASE("linear in position: onward, across, at rest and back") {
  auto printed = after_two_samples("linear_position"),
       with_sign = after_two_samples("linear_position_signed");
  const Vec3 onward(0.003, 0, 0), across(0.002, 0.005, 0.001), oblique(0.003, 0.004, 0), back(0.001, 0, 0);
  for (const auto& l : {printed.get(), with_sign.get()}) {
    CHECK(l->force(onward, 50ms)[1] == Approx(2.5));   // half a step on
    CHECK(l->force(across, 50ms)[1] == Approx(2));     // the projection does not move
    CHECK(l->force(oblique, 50ms)[1] == Approx(2.5));  // only what lies along the line counts
  }
  CHECK(printed->force(back, 50ms)[1] == Approx(2.5));  // as printed: no sign, the wrong way on a reversal
  CHECK(with_sign->force(back, 50ms)[1] == Approx(1.5));
}

TEST_CASE("with one sample, or two at the same place or time, the answer is F_n") {
  for (const char* name : {"linear_time", "linear_position", "linear_position_signed"}) {
    CAPTURE(name);
    auto l = law(name);
    CHECK(l->force({1, 1, 1}, 10ms) == Vec3::Zero());
    l->update({1, 0ms, {0, 0, 0}, {0, 1, 0}});
    CHECK(l->force({1, 1, 1}, 10ms) == Vec3(0, 1, 0));
  }
  for (const char* name : {"linear_position", "linear_position_signed"}) {
    auto l = law(name);
    l->update({1, 0ms, {0, 0, 0}, {0, 1, 0}});
    l->update({2, 40ms, {0, 0, 0}, {0, 3, 0}});
    CHECK(l->force({1, 0, 0}, 50ms) == Vec3(0, 3, 0));
  }
}

TEST_CASE("linear in position: a step of less than 20 um counts as one of 20 um") {
  // A tool that creeps 3 nm while the organ under it changes the force by 0.1 N, and then goes 1 mm.
  for (const char* name : {"linear_position", "linear_position_signed"}) {
    CAPTURE(name);
    auto l = law(name);
    l->update({1, 0ms, {0, 0, 0}, {0, 1, 0}});
    l->update({2, 40ms, {3e-9, 0, 0}, {0, 1.1, 0}});
    CHECK(l->force({3e-9 + 1e-3, 0, 0}, 50ms)[1] == Approx(1.1 + 0.1 * 1e-3 / 20e-6));
    l->update({3, 80ms, {3e-9 + 20e-6, 0, 0}, {0, 1.3, 0}});
    CHECK(l->force({3e-9 + 30e-6, 0, 0}, 90ms)[1] == Approx(1.4));  // as printed from there on
  }
}

TEST_CASE("kalman: on a straight ramp without noise it is linear in time, from a few samples on") {
  Kalman kalman;
  const auto ramp = [](double t) { return Vec3(1 + 2 * t, -t, 0.5); };
  for (int n = 1; n <= 10; ++n) {
    const double t = 0.033 * n;
    kalman.update({static_cast<std::uint64_t>(n), from_seconds(t), Vec3::Zero(), ramp(t)});
  }
  CHECK((kalman.force(Vec3::Zero(), from_seconds(0.36)) - ramp(0.36)).norm() < 1e-4);
}

TEST_CASE("interpolate with delay: the force of two periods ago, on the line between samples") {
  InterpolateWithDelay late;
  for (int n = 1; n <= 6; ++n)
    late.update({static_cast<std::uint64_t>(n), Time{n * 40'000'000}, Vec3::Zero(), Vec3(n * n, 0, 0)});
  // 250 - 80 = 170 ms lies a quarter of the way from sample 4 (160 ms) to 5.
  CHECK(late.force(Vec3::Zero(), Time{250'000'000})[0] == Approx(16 + 0.25 * 9));
  CHECK(late.force(Vec3::Zero(), Time{900'000'000})[0] == 36);  // the newest, when all are old
}
