#include "common/force_jumps.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/catch.h"

using namespace palpate;

namespace {

/// Snaps of `force` (a function of s, N) over 2 s, at a rate.
template <class Force>
ForceJumps snaps_at(double rate_hz, Force force) {
  SnapCounter counter(rate_hz);
  for (int i = 0; i < 2 * rate_hz; ++i) counter.add(force(i / rate_hz), from_seconds(i / rate_hz));
  const auto snaps = counter.snaps();
  REQUIRE(snaps);
  return *snaps;
}

/// A ramp to 10 N in 2 s, with steps of some N between samples of every rate, across the ramp's direction.
Vec3 ramp_with_steps(double t) {
  double across = 0;
  for (const auto& [at, height] : {std::pair{0.30013, 1.0}, {0.7003, -0.8}, {1.2007, 0.4}, {1.6009, -0.6}})
    across += t > at ? height : 0;
  return {across, 5 * t, 0};
}

/// A spring of 1000 N/m that is pressed by `depth` (m), at 30 Hz, with its tangent.
PublishedForce on_spring(std::uint64_t number, double depth) {
  return {.number = number,
          .t = from_seconds(static_cast<double>(number) / 30),
          .p = {0, -depth, 0},
          .f = {0, std::max(1000 * depth, 0.0), 0},
          .tangent = Vec3(0, -1000, 0).asDiagonal().toDenseMatrix()};
}

}  // namespace

TEST_CASE("steps on a ramp are counted from 5 % of the peak on, and measured, at 2 kHz as at 8 kHz") {
  const double peak = ramp_with_steps(1.99999).norm();  // about 10 N: the step of 0.4 N is too small
  for (const double rate_hz : {2000.0, 4000.0, 8000.0, 20000.0}) {
    CAPTURE(rate_hz);
    const ForceJumps snaps = snaps_at(rate_hz, ramp_with_steps);
    CHECK(snaps.count == 3);
    CHECK(snaps.largest_percent == Approx(100 * 1.0 / peak).epsilon(1e-3));
  }
}

TEST_CASE("a fast smooth motion on a stiff spring, its onset and a corner of its speed are no snaps") {
  // Into contact and out of it 30 times a second: at most 19 m/s, by up to 9.4 % of the peak in 0.5 ms.
  const auto pressed = [](double t) {
    return Vec3(0, std::max(1000 * 0.1 * std::sin(2 * std::numbers::pi * 30 * t), 0.0), 0);
  };
  // A speed that changes its sign at once, by 10 % of the peak in 0.5 ms.
  const auto corner = [](double t) { return Vec3(0, 10 - 2000 * std::abs(std::remainder(t, 0.01)), 0); };
  for (const double rate_hz : {2000.0, 8000.0}) {
    CAPTURE(rate_hz);
    CHECK(snaps_at(rate_hz, pressed).count == 0);
    CHECK(snaps_at(rate_hz, pressed).largest_percent < 0.4);
    CHECK(snaps_at(rate_hz, corner).count == 0);
    CHECK(snaps_at(rate_hz, corner).largest_percent == Approx(0).margin(1e-6));
  }
}

TEST_CASE("a gap is no snap, and samples that are too slow or push nothing measure none") {
  SnapCounter gap(2000), slow(1000), free(2000);
  for (int i = 0; i < 1000; ++i) {
    const Time t = i * std::chrono::microseconds(500);
    gap.add({0, i < 500 ? 1.0 : 2.0, 0}, i < 500 ? t : t + std::chrono::milliseconds(5));
    slow.add({0, i < 500 ? 1.0 : 2.0, 0}, 2 * t);
    free.add(Vec3::Zero(), t);
  }
  CHECK(gap.snaps()->count == 0);
  CHECK_FALSE(slow.snaps());
  CHECK_FALSE(free.snaps());
  Json report = Json::object();
  add_to(report, "snap", slow.snaps());
  CHECK(report.empty());
  add_to(report, "snap", ForceJumps{2, 45.8});
  CHECK(report.dump() == R"({"snaps":2,"largest_snap_percent":45.8})");
  CHECK(jumps_in(report, "snap")->count == 2);
  CHECK(jumps_in(report, "snap")->largest_percent == 45.8);
  CHECK_FALSE(jumps_in(report, "unexplained_jump"));
  report["snaps"] = nullptr;  // a row of a table that did not measure it
  CHECK_FALSE(jumps_in(report, "snap"));
}

TEST_CASE("published tangents explain all of a spring, however it is pressed and left") {
  UnexplainedJumps jumps;
  for (std::uint64_t n = 1; n <= 60; ++n)
    jumps.add(on_spring(n, 0.01 * std::sin(0.5 * static_cast<double>(n))));
  CHECK(jumps.jumps()->count == 0);
  CHECK(jumps.jumps()->largest_percent == Approx(0).margin(1e-9));
}

TEST_CASE("a jump between two samples is measured across what the tangents say") {
  UnexplainedJumps jumps, plain, cut, sessions;
  const auto both = [](UnexplainedJumps& all, PublishedForce a, PublishedForce b) { all.add(a), all.add(b); };
  PublishedForce before = on_spring(1, 0.01), after = on_spring(2, 0.015);
  after.f += Vec3(3, 0, 0);
  both(jumps, before, after);
  CHECK(jumps.jumps()->count == 1);
  CHECK(jumps.jumps()->largest_percent == Approx(100 * 3 / std::hypot(15, 3)));
  after.tangent = {};
  both(plain, before, after);
  CHECK_FALSE(plain.jumps());
  after = on_spring(2, 0.015), after.cuts = 1;
  both(cut, before, after);
  CHECK_FALSE(cut.jumps());
  PublishedForce earlier = on_spring(9, 0.02);
  earlier.t = before.t - std::chrono::milliseconds(33);
  both(sessions, earlier, before);
  CHECK_FALSE(sessions.jumps());
}

TEST_CASE(
    "an organ that moves with the tool changes nothing, and its motion is part of what tangents explain") {
  UnexplainedJumps jumps;
  for (std::uint64_t n = 1; n <= 30; ++n) {
    PublishedForce sample = on_spring(n, 0.01);  // at one place of the organ, which goes at 0.3 m/s
    sample.p += Vec3(0, 0.3 * to_seconds(sample.t), 0);
    sample.surface_v = {0, 0.3, 0};
    jumps.add(sample);
  }
  CHECK(jumps.jumps()->largest_percent == Approx(0).margin(1e-6));
}
