// What every extrapolation law must do, row by row of the registry.
#include <array>
#include <limits>

#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/contract.h"
#include "tests/support/random.h"
#include "tests/support/served_block.h"

using namespace palpate;
using namespace palpate::client;

namespace {

/// What a server tells of a block, and its model, whole.
struct Published {
  Published() {
    const sim::Simulation simulation(test::block_scene(), test::block_mesh());
    model.announce(sim::SurfacePager(simulation, 0).state());
    for (const protocol::SurfacePage& page : test::all_pages(simulation)) model.take(page);
  }
  SurfaceModel model;
};
Published& published() {
  static Published once;
  return once;
}

constexpr Time kPeriod = std::chrono::microseconds(30030), kAMinute = std::chrono::seconds(60);
const Vec3 kPressed(0.001, 0.0035, 0.0005), kAway(0.001, 0.008, 0.0005);

/// The force on a tool at rest, at every tick; `part` takes away what a sample shall not tell.
template <class Part>
void rest_and_leave(ForceEstimate& estimate, Part part) {
  test::ServedBlock block(Time::zero(), 1, kPeriod);
  Vec3 settled = Vec3::Zero(), given = Vec3::Zero();
  std::uint64_t free = 0;
  const test::AllocationGuard guard;
  bool ticks_allocate_nothing = true;
  for (Time t{1}; t < kAMinute + std::chrono::milliseconds(500); t += kPeriod / 3) {
    const Vec3 p = t < kAMinute ? kPressed : kAway;
    if (const auto sent = block.exchange(t, p, Vec3::Zero())) {
      Sample sample = sample_of(*sent, &published().model);
      part(sample);
      const std::size_t before_sample = guard.count();
      const bool taken = estimate.take(sample, p, t);
      ticks_allocate_nothing = guard.count() == before_sample && ticks_allocate_nothing;
      REQUIRE(taken);
      free += sample.f.isZero(0) ? 1 : 0;
    }
    const std::size_t before_tick = guard.count();
    given = estimate.force(p, t);
    ticks_allocate_nothing = guard.count() == before_tick && ticks_allocate_nothing;
    REQUIRE(given.allFinite());
    if (estimate.newest().number == 2 && settled.isZero(0)) settled = given;
    if (estimate.newest().number >= 2 && t < kAMinute)
      REQUIRE((given - settled).norm() <= 1e-9 * settled.norm());
    if (free > 0) REQUIRE(given == Vec3::Zero());
  }
  CHECK(ticks_allocate_nothing);
  CHECK(settled.norm() > 0.1);
  CHECK(free > 10);
}

}  // namespace

CONTRACT("every extrapolation law", ExtrapolatorRow, row, extrapolators()) {
  const auto law = row.make();
  SECTION("no force before the first sample") {
    CHECK(law->force({0.1, 0.2, 0.3}, Time{5}) == Vec3::Zero());
  }
  SECTION("at the sample itself, its force") {
    test::Random random(10);
    for (int n = 1; n <= 50; ++n) {
      const Sample sample{static_cast<std::uint64_t>(n), Time{n * 33'000'000}, random.vector(0.01),
                          random.vector(2)};
      law->update(sample);
      if (row.exact) CHECK((law->force(sample.p, sample.t) - sample.f).norm() < 1e-12);
    }
  }
  SECTION("a constant force stays constant, wherever and whenever") {
    test::Random random(11);
    for (int n = 1; n <= 10; ++n) {
      law->update({static_cast<std::uint64_t>(n), Time{n * 33'000'000}, random.vector(0.01), {1, -2, 3}});
    }
    CHECK((law->force(random.vector(0.01), Time{350'000'000}) - Vec3(1, -2, 3)).norm() < 1e-12);
  }
  SECTION("whatever it is given, the answer is finite") {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const std::array implausible{
        0.0, 1e-12, -0.001, 1e30, -1e30, kNan, std::numeric_limits<double>::infinity()};
    const std::array<std::int64_t, 5> times{0, 1, 33'000'000, 33'000'000, std::int64_t{1} << 61};
    test::Random random(12);
    const auto any = [&] { return implausible[static_cast<std::size_t>(random.between(0, 6.999))]; };
    for (int n = 1; n <= 5000; ++n) {
      const Sample sample{static_cast<std::uint64_t>(n),
                          Time{times[static_cast<std::size_t>(random.between(0, 4.999))]},
                          {any(), any(), any()},
                          {any(), any(), any()}};
      law->update(sample);
      if (n % 3 == 0) law->update(sample);  // again: same time, same place
      CHECK(law->force({any(), any(), any()}, sample.t).allFinite());
      CHECK(law->force(sample.p, sample.t + Time{2'000'000}).allFinite());
    }
  }
  SECTION("whatever the parts of a sample hold, the answer is finite") {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const std::array implausible{
        0.0, 1e-300, 5e-324, 1e-12, 0.001, 0.005, -0.001, 1.0,   10.0,
        1e6, 1e9,    -1e9,   1e30,  -1e30, 1e300, kNan,   -kNan, std::numeric_limits<double>::infinity()};
    test::Random random(13);
    const auto any = [&] {
      return implausible[static_cast<std::size_t>(random.between(0, implausible.size() - 1e-3))];
    };
    const auto near = [&] { return Vec3(kPressed + random.vector(0.001)); };
    // A wall, mostly, with some wild numbers in it; one in three is free.
    const auto any_linear = [&] {
      Linearisation l{.p_W = near(), .f_W = random.vector(2), .normal_W = {0, 1, 0}, .gap = 0.001};
      l.tangent = -500 * Mat3::Identity();
      if (random.between(0, 3) < 1) l.f_W.setZero();
      auto& [p, f, k, n, gap] = l;
      double* const numbers[] = {&p[0],    &p[1], &f[0], &f[2], &k(0, 0), &k(1, 1),
                                 &k(0, 1), &n[0], &n[1], &n[2], &gap};
      for (double* const number : numbers) *number = random.between(0, 8) < 1 ? any() : *number;
      return l;
    };
    const auto any_surface = [&](const SurfaceModel& model) {
      Surface s{
          &model, random.vector(0.001), {.radius = 0.005, .friction = random.between(0, 2) < 1 ? 0 : 0.3}, 0};
      double* const numbers[] = {&s.shift[0], &s.shift[1], &s.tool.radius, &s.tool.friction,
                                 &s.tool_compliance};
      for (double* const number : numbers) *number = random.between(0, 8) < 1 ? any() : *number;
      return s;
    };
    const SurfaceModel empty;
    for (int n = 1; n <= 3000; ++n) {
      const Time t = n * std::chrono::milliseconds(33);
      Sample sample{static_cast<std::uint64_t>(n), t, near(), random.vector(2)};
      if (n % 8 == 0) sample.surface_v[n % 3] = any();
      if (n % 4 != 0) sample.at_tool = any_linear();
      if (n % 5 != 0) sample.ahead = any_linear();
      if (n % 6 != 0) sample.surface = any_surface(n % 10 == 0 ? empty : published().model);
      law->update(sample);
      CHECK(law->force(near(), t).allFinite());
      CHECK(law->force({any(), any(), any()}, t + Time{1'000'000}).allFinite());
      CHECK(law->force(sample.p, t + Time{2'000'000}).allFinite());
    }
  }
  SECTION("a tool at rest for a minute: a constant force, which ends when it leaves") {
    const auto everything = [](Sample&) {};
    const auto no_surface = [](Sample& s) { s.surface.reset(); };
    const auto triplet = [](Sample& s) { s = {s.number, s.t, s.p, s.f}; };
    {
      ForceEstimate estimate(row.make());
      rest_and_leave(estimate, everything);
    }
    {
      ForceEstimate estimate(row.make());
      rest_and_leave(estimate, no_surface);
    }
    ForceEstimate estimate(row.make());
    rest_and_leave(estimate, triplet);
  }
  SECTION("a sample that is not finite changes nothing, one that comes again neither") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    law->update({1, Time{0}, {0, 0, 0}, {0, 1, 0}});
    law->update({2, Time{33'000'000}, {0.001, 0, 0}, {0, 2, 0}});
    const Vec3 p(0.0015, 0, 0);
    const Vec3 before = law->force(p, Time{40'000'000});
    law->update({3, Time{66'000'000}, {nan, 0, 0}, {0, 3, 0}});
    law->update({4, Time{66'000'000}, {0, 0, 0}, {0, 3, nan}});
    law->update({2, Time{33'000'000}, {0.001, 0, 0}, {0, 2, 0}});
    CHECK(law->force(p, Time{40'000'000}) == before);
  }
  SECTION("it does not allocate") {
    std::size_t allocations = 1;
    {
      const test::AllocationGuard guard;
      law->update({1, Time{0}, {0, 0, 0}, {0, 1, 0}});
      law->update({2, Time{33'000'000}, {0.001, 0, 0}, {0, 2, 0}});
      law->force({0.002, 0, 0}, Time{40'000'000});
      allocations = guard.count();
    }
    CHECK(allocations == 0);
  }
}
