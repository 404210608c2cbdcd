// The law that solves contact itself, against the simulation it stands for: what both say of the same places.
#include "haptic_client/extrapolation/local_contact.h"

#include <cmath>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/listener.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;
using namespace palpate::test;
using namespace std::chrono_literals;

namespace {

std::uint32_t first_tile(const Listener& listener) {
  const auto state = sim::SurfacePager(listener.block.simulation, 0).state();
  return protocol::SurfacePages{state.vertices, state.triangles}.first_tile();
}

/// The model with all compliance `factor` times what it is.
void learn_wrong(Listener& listener, float factor) {
  const std::uint32_t tiles = first_tile(listener);
  listener.learn([&](protocol::SurfacePage& page) {
    if (page.page < tiles) return true;
    for (float& value : page.values) value *= factor;
    return true;
  });
}

}  // namespace

TEST_CASE(
    "local contact: on the server's model it is the server's force, in and out of contact, whatever the "
    "delay") {
  for (const Time delay : {0ms, 35ms, 80ms}) {
    Listener listener(delay);
    listener.learn(kEntireModel);
    const Errors errors = follow(listener);
    CAPTURE(delay.count(), errors.mean, errors.largest);
    CHECK(errors.mean < 5e-4);
    CHECK(errors.largest < 0.01);
  }
}

TEST_CASE(
    "local contact: a compliance wrong by 30 % is made up for, so that the sample's place has its force") {
  for (const float factor : {0.7f, 1.3f}) {
    Listener listener;
    learn_wrong(listener, factor);
    const Errors errors = follow(listener);
    CAPTURE(factor, errors.mean, errors.largest);
    CHECK(errors.mean < 1e-3);
    CHECK(errors.largest < 0.02);
    const Vec3 f_n = listener.newest.f_W;
    CHECK((listener.law.force(listener.newest.p_W, listener.t) - f_n).norm() < 1e-3 * f_n.norm() + 1e-9);
  }
}

TEST_CASE("local contact: that the compliance is wrong is seen ahead of the first touch") {
  for (const float factor : {0.7f, 1.3f}) {
    Listener listener;
    learn_wrong(listener, factor);
    sim::Simulation truth(block_scene(), block_mesh());
    double largest = 0, peak = 0;
    for (int i = 0; i < 150; ++i) {  // down at 30 mm/s
      const Vec3 p(0.001, std::max(0.0125 - 6e-5 * i, 0.0035), 0.0005);
      const Vec3 right = truth.step(p, 0.002).force;
      largest = std::max(largest, (listener.tick(p) - right).norm());
      peak = std::max(peak, right.norm());
    }
    CAPTURE(factor);
    CHECK(largest < 0.03 * peak);
  }
}

TEST_CASE("local contact: without the compliance it is two tangents") {
  Listener listener;
  const std::uint32_t tiles = first_tile(listener);
  listener.learn([&](const protocol::SurfacePage& page) { return page.page < tiles; });
  ForceEstimate other(std::make_unique<TwoTangents>());
  for (int i = 0; i < 1000; ++i) {
    const auto number = listener.newest.number;
    const Vec3 given = listener.tick(slide(listener.t + kTick));
    if (listener.newest.number != number)
      other.take(sample_of(listener.newest, &listener.model), listener.place, listener.t);
    CHECK(given == other.force(listener.place, listener.t));
  }
}

TEST_CASE("local contact: where pages are missing it steps down and up again, no worse than two tangents") {
  Listener holes, none;
  holes.learn([&](const protocol::SurfacePage& page) { return page.page % 40 != 39; });
  const Errors with = follow(holes), without = follow(none);
  CAPTURE(with.mean, without.mean, with.largest, without.largest);
  CHECK(with.mean < without.mean);
  CHECK(with.largest < 1.5 * without.largest);
}

TEST_CASE("local contact: of a tool that sticks already it says nothing before that was compared") {
  sim::Scene scene = block_scene();
  scene.tools.front().shape.friction = 2;
  Listener listener(scene, block_mesh());
  sim::Simulation truth(scene, block_mesh());
  double before = 0, after = 0;  // largest errors, N
  for (int i = 0; i < 240; ++i) {
    if (i == 200)
      listener.learn(kEntireModel);  // it does not know how far the tool has drawn the tissue aside
    const Vec3 p(4e-5 * i, 0.003, 0.0005), given = listener.tick(p), right = truth.step(p, 0.002).force;
    double& largest = i < 200 ? before : after;
    if (i >= 100) largest = std::max(largest, (given - right).norm());
  }
  CAPTURE(before, after);
  CHECK(after < 2 * before);
}

TEST_CASE("local contact: pages that come while the tool presses help from the next sample on") {
  Listener listener;
  listener.learn([](const protocol::SurfacePage& page) { return page.page < 100; });
  follow(listener, 600ms);
  listener.learn(kEntireModel);
  follow(listener, 100ms);
  CHECK(follow(listener, 1s).mean < 5e-4);
}

TEST_CASE("local contact: what the other tool presses is felt through the tissue") {
  Listener listener(35ms, 2);
  listener.learn(kEntireModel);
  sim::Simulation truth(block_scene(2), block_mesh());
  const Vec3 other(0.008, 0.0025, 0);
  listener.block.hold_second_tool(other);
  double peak = 0, sum = 0;
  for (int i = 0; i < 1500; ++i) {
    const Vec3 p(-0.004 + 0.002 * std::sin(0.004 * i), 0.0035, 0);
    const std::vector<sim::ToolInput> inputs{{.pose = p}, {.pose = other}};
    const Vec3 right = truth.step(inputs, 0.002)[0].force, given = listener.tick(p);
    peak = std::max(peak, right.norm());
    if (i > 100) sum += (given - right).norm() / 1400;
  }
  CHECK(sum < 0.01 * peak);
}

TEST_CASE(
    "local contact: at rest for a minute it holds its force, and lets go at once when the tool leaves") {
  Listener listener;
  listener.learn(kEntireModel);
  const Vec3 deep(0.001, 0.0035, 0.0005), out(0.001, 0.006, 0.0005);
  for (double fraction = 0; fraction < 1; fraction += 0.005) listener.tick(out + fraction * (deep - out));
  const Vec3 first = listener.tick(deep);
  Vec3 settled = first, last = first;
  for (int i = 0; i < 50; ++i) settled = listener.tick(deep);  // a sample of that place has come
  for (int i = 0; i < 30000; ++i) last = listener.tick(deep);
  CHECK((settled - first).norm() < 1e-3 * first.norm());
  CHECK((last - settled).norm() < 1e-7 * first.norm());
  CHECK(listener.tick(out) == Vec3::Zero());
}

TEST_CASE(
    "local contact: jumps, wild places and a compliance that is not positive: finite, and no more than a "
    "blow") {
  for (const bool broken : {false, true}) {
    CAPTURE(broken);
    Listener listener;
    Random random(4);
    const std::uint32_t tiles = first_tile(listener);
    listener.learn([&](protocol::SurfacePage& page) {
      if (broken && page.page >= tiles) {
        for (float& value : page.values) value = -value;
      }
      return true;
    });
    double largest = 0, served = 0;
    for (int i = 0; i < 3000; ++i) {
      Vec3 p = slide(listener.t);
      if (i % 97 == 0) p += random.vector(0.1);
      if (i % 501 == 0) p = random.vector(1e6);
      const Vec3 f = listener.tick(p);
      REQUIRE(f.allFinite());
      if (i % 97 > 30 && i % 501 > 30) largest = std::max(largest, f.norm());
      served = std::max(served, listener.newest.f_W.norm());
    }
    CHECK(largest < 3 * served);
  }
}

TEST_CASE("local contact: a delay that jumps from 5 to 200 ms changes nothing that is felt") {
  Listener listener(5ms);
  listener.learn(kEntireModel);
  follow(listener, 500ms);
  listener.block.set_delay(200ms);
  CHECK(follow(listener, 2s).largest < 0.01);
}

TEST_CASE("local contact: samples older than three periods, where time stands still for laws: as exact") {
  Listener listener(80ms, 1, 10ms);
  listener.learn(kEntireModel);
  const Errors errors = follow(listener);
  CAPTURE(errors.mean, errors.largest);
  CHECK(errors.mean < 5e-4);
  CHECK(errors.largest < 0.01);
}

TEST_CASE("local contact: ticks and arrivals do not allocate") {
  Listener listener;
  listener.learn(kEntireModel);
  follow(listener, 600ms);
  std::vector<std::pair<Vec3, std::optional<protocol::ForceSample>>> ticks;
  for (int i = 0; i < 400; ++i) {
    const Vec3 p = slide(listener.t += kTick);
    ticks.emplace_back(p, listener.block.exchange(listener.t, p, Vec3::Zero()));
  }
  std::size_t allocations = 1;
  {
    const AllocationGuard guard;
    for (const auto& [p, sample] : ticks) {
      if (sample) listener.law.take(sample_of(*sample, &listener.model), p, listener.t);
      listener.law.force(p, listener.t);
    }
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
