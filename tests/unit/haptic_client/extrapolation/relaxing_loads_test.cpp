// What the surface of a tissue that relaxes remembers of the loads on it, against the closed form of one
// term: under a force f held from t = 0, psi = f (1 - exp(-(1 - g) t / tau)) / (1 - g).
#include "haptic_client/extrapolation/relaxing_loads.h"

#include <cmath>

#include "protocol/surface_pages.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;
using protocol::SurfacePage;
using protocol::SurfacePages;

namespace {

constexpr double kFraction = 0.5, kTime = 0.2, kCompliance = 0.004;  // -, s, m/N
constexpr std::array kSeries{Relaxation{kFraction, kTime}};
constexpr std::uint32_t kVertices = 60, kHeld = 59;

/// Vertices that do not move each other, the last of them held.
SurfaceModel surface() {
  SurfaceModel model;
  model.announce({.version = 7, .vertices = kVertices, .triangles = 1, .tool_radius = 0.005}, 1);
  const SurfacePages pages{kVertices, 1, 1};
  for (std::uint32_t number = 0; number < pages.count(); ++number) {
    SurfacePage page{.version = 7, .page = number};
    if (number == pages.spectrum()) page.values = {30, 4};
    if (number >= pages.first_tile() && number < pages.spectrum()) {
      const auto [a, b] = pages.clusters_of(number);
      for (std::size_t i = 0; a == b && i < 15; ++i) page.values[16 * i] = static_cast<float>(kCompliance);
    }
    for (std::uint32_t vertex = 0; number > pages.spectrum() && vertex < 5; ++vertex) {
      const bool held = pages.cluster_and_group_of(number).first * 5 + vertex == kHeld;
      page.values[(3 * vertex + 1) * SurfacePages::kModes] = held ? 0 : 2;
    }
    model.take(page);
  }
  return model;
}

double crept(double t) {
  return -std::expm1(-(1 - kFraction) * t / kTime) / (1 - kFraction);
}

protocol::RelaxedState published(int number, const Vec3& psi) {
  protocol::RelaxedState state{.terms = 1, .vertices = 1};
  state.fraction[0] = static_cast<float>(kFraction);
  state.time[0] = static_cast<float>(kTime);
  state.vertex[0].number = static_cast<std::uint16_t>(number);
  for (std::size_t axis = 0; axis < 3; ++axis)
    state.vertex[0].psi[axis] = static_cast<float>(psi[static_cast<Eigen::Index>(axis)]);
  return state;
}

}  // namespace

TEST_CASE(
    "relaxing loads: a vertex that is pressed creeps by the closed form, and comes back when it is not") {
  const SurfaceModel model = surface();
  const std::array pressed{VertexLoad{3, Vec3(0, -2, 1)}, VertexLoad{kHeld, Vec3(0, -5, 0)}};
  RelaxingLoads loads;
  loads.begin(0s, kSeries);
  loads.apply_loads(model, pressed, 0.5);
  const Vec3 f(0, -1, 0.5);
  for (Time t = 2ms; t <= 300ms; t += 2ms) {
    loads.advance(t);
    loads.apply_loads(model, pressed, 0.5);
  }
  CHECK((loads.creep(model, 3) - kCompliance * kFraction * crept(0.3) * f).norm() < 1e-4 * kCompliance);
  CHECK(loads.creep(model, 4).isZero(0));
  CHECK(loads.creep(model, kHeld).isZero(0));  // the wall does not creep
  for (Time t = 302ms; t <= 500ms; t += 2ms) {
    loads.apply_loads(model, {}, 0);
    loads.advance(t);
  }
  const double left = crept(0.3) * std::exp(-(1 - kFraction) * 0.2 / kTime);
  CHECK((loads.creep(model, 3) - kCompliance * kFraction * left * f).norm() < 1e-4 * kCompliance);
}

TEST_CASE(
    "relaxing loads: what a sample says of the past goes on to now under the loads since, in any delay") {
  const SurfaceModel model = surface();
  const std::array pressed{VertexLoad{3, Vec3(0, -1, 0)}};
  for (const Time delay : {0ms, 20ms, 90ms}) {
    for (const Time tick : {2ms, 5ms}) {
      CAPTURE(delay.count(), tick.count());
      RelaxingLoads loads;  // of a client that joins at 0.4 s, and has been told nothing before
      loads.begin(400ms, kSeries);
      Time t = 400ms;
      for (; t <= 400ms + delay; t += tick) {
        loads.advance(t);
        loads.apply_loads(model, pressed, 1);
      }
      loads.take(model, published(3, {0, -crept(0.4), 0}), 400ms);
      for (; t <= 600ms; t += tick) {
        loads.advance(t);
        loads.apply_loads(model, pressed, 1);
      }
      const Vec3 right(0, -kCompliance * kFraction * crept(to_seconds(t - tick)), 0);
      CHECK((loads.creep(model, 3) - right).norm() < 2e-3 * right.norm());
    }
  }
}

TEST_CASE("relaxing loads: vertices beyond their number, and of no model, change nothing and are bounded") {
  const SurfaceModel model = surface();
  RelaxingLoads loads;
  const test::AllocationGuard guard;
  loads.begin(0s, kSeries);
  Time t = 2ms;
  for (int number = 0; number < 2 * static_cast<int>(kVertices); ++number, t += 2ms) {
    const std::array pressed{VertexLoad{number % static_cast<int>(kHeld), Vec3(0, -1, 0)}};
    loads.advance(t);
    loads.apply_loads(model, pressed, 1);
    loads.take(model, published(60000, Vec3(0, -1, 0)), t);
    CHECK(loads.creeping().size() <= RelaxingLoads::kMost);
  }
  CHECK(loads.creep(model, (2 * static_cast<int>(kVertices) - 2) % static_cast<int>(kHeld)).norm() > 0);
  CHECK(guard.count() == 0);
}
