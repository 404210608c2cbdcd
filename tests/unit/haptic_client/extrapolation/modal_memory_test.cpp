// The slow modes as a client steps them, on a surface of one triangle with modes made up by hand.
#include "haptic_client/extrapolation/modal_memory.h"

#include <cmath>

#include "protocol/surface_pages.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;
using protocol::SurfacePage;
using protocol::SurfacePages;

namespace {

constexpr double kFraction = 0.5, kTime = 0.125;     // of a term, s
constexpr double kW = 30, kDamping = 4, kShape = 2;  // rad/s, 1/s, 1/sqrt(kg): 0.25 kg

/// A triangle that one mode moves along y as one piece.
struct Triangle {
  SurfaceModel model;
  Triangle() {
    const protocol::SurfaceState state{.version = 7, .vertices = 3, .triangles = 1, .tool_radius = 0.005};
    model.announce(state, 1);
    const SurfacePages pages{3, 1, 1};
    SurfacePage places{.version = 7, .page = 0};
    places.values = {0, 0, 0, 0.01f, 0, 0, 0, 0, 0.01f};
    SurfacePage corners{.version = 7, .page = pages.first_triangle_page()};
    corners.values = {0, 1, 2};
    SurfacePage spectrum{.version = 7, .page = pages.spectrum()};
    spectrum.values = {static_cast<float>(kW), static_cast<float>(kDamping)};
    SurfacePage shapes{.version = 7, .page = pages.shapes(0, 0)};
    for (std::size_t vertex = 0; vertex < 3; ++vertex)
      shapes.values[(3 * vertex + 1) * SurfacePages::kModes] = static_cast<float>(kShape);
    for (const SurfacePage& page : {places, corners, spectrum, shapes}) model.take(page);
  }
  /// Of a tissue that relaxes by one term.
  Surface published(double q, double v, double z) const {
    Surface surface = published(q, v);
    surface.relaxed = {.terms = 1, .count = 1};
    surface.relaxed.fraction[0] = static_cast<float>(kFraction);
    surface.relaxed.time[0] = static_cast<float>(kTime);
    surface.relaxed.z[0] = static_cast<float>(z);
    return surface;
  }
  Surface published(double q, double v) const {
    Surface surface{.model = &model, .tool = {.radius = 0.005}};
    surface.modes.count = 1;
    surface.modes.q[0] = static_cast<float>(q);
    surface.modes.v[0] = static_cast<float>(v);
    return surface;
  }
};

/// q and q' at time t (s), from q = 0.01 and q' = 0, free of any force: the closed form.
std::pair<double, double> swung(double t) {
  const double g = kDamping / 2, r = std::sqrt(kW * kW - g * g), e = 0.01 * std::exp(-g * t);
  return {e * (std::cos(r * t) + g / r * std::sin(r * t)), -e * kW * kW / r * std::sin(r * t)};
}

/// q, q' and z at time t (s) from a state, under a force p that is held: x' = A (x - rest), by eigenvectors.
Eigen::Vector3d relaxed(double t, const Eigen::Vector3d& from, double p) {
  Eigen::Matrix3d a;
  a << 0, 1, 0, -kW * kW, -kDamping, kW * kW * kFraction, 1 / kTime, 0, -1 / kTime;
  const double q = p / (kW * kW * (1 - kFraction));
  const Eigen::Vector3d rest(q, 0, q);
  return rest + test::solution_at(t, a, from - rest);
}

}  // namespace

TEST_CASE("modal memory: a mode of a tissue that relaxes is a standard linear solid with a mass") {
  const Triangle triangle;
  for (const Time tick : {2000us, 333us, 1777us}) {
    CAPTURE(tick.count());
    ModalMemory memory;
    REQUIRE(memory.place_near(triangle.model, Vec3::Zero()));
    REQUIRE(memory.take(triangle.published(0, 0, 0), 1s, Vec3::Zero()));
    const Vec3 f(0, 3, 0);  // N, on the tool
    const double p = -3 * kShape;
    memory.advance(1s + 1us);
    memory.apply_loads(f);  // from now on
    double worst = 0;
    for (Time t = 1s + tick; t < 2s; t += tick) {
      memory.advance(t);
      memory.apply_loads(f);
      const double right = kShape * relaxed(to_seconds(t - 1s), Eigen::Vector3d::Zero(), p)[0];
      worst = std::max(worst, std::abs(memory.displacement()[1] - right));
    }
    const double at_once = kShape * std::abs(p) / (kW * kW);
    CHECK(worst < 2e-3 * at_once);
    CHECK(std::abs(memory.displacement()[1]) > 1.7 * at_once);  // it has relaxed by then
  }
}

TEST_CASE("modal memory: what followed a mode late is set right by the first sample that tells of it") {
  const Triangle triangle;
  const Eigen::Vector3d from(0.01, 0, 0.004);
  for (const Time delay : {0ms, 36ms, 80ms}) {
    CAPTURE(delay.count());
    ModalMemory memory;
    REQUIRE(memory.place_near(triangle.model, Vec3::Zero()));
    REQUIRE(memory.take(triangle.published(0.01, 0, -0.01), 0s, Vec3::Zero()));  // wrong: z is 0.004
    Time sampled = 30ms;
    double before = 0, worst = 0;
    for (Time t = 2ms; t < 1s; t += 2ms) {
      if (t == sampled + delay) {
        const Eigen::Vector3d then = relaxed(to_seconds(sampled), from, 0);
        REQUIRE(memory.take(triangle.published(then[0], then[1], then[2]), sampled, Vec3::Zero()));
        sampled += 30ms;
      }
      memory.advance(t);
      memory.apply_loads(Vec3::Zero());
      const double off = std::abs(memory.displacement()[1] - kShape * relaxed(to_seconds(t), from, 0)[0]);
      (t < 30ms + delay ? before : worst) = std::max(t < 30ms + delay ? before : worst, off);
    }
    CAPTURE(before);
    CHECK(before > 0.1 * kShape * 0.01);
    CHECK(worst < 2e-3 * kShape * 0.01);
  }
}

TEST_CASE("modal memory: goes on as the closed form, whatever the ticks") {
  const Triangle triangle;
  for (const Time tick : {2000us, 1000us, 333us, 1777us}) {
    CAPTURE(tick.count());
    ModalMemory memory;
    REQUIRE(memory.place_near(triangle.model, Vec3(0.001, 0, 0.001)));
    REQUIRE(memory.take(triangle.published(0.01, 0), 1s, Vec3::Zero()));
    double worst = 0;
    for (Time t = 1s + tick; t < 1200ms; t += tick) {
      memory.advance(t);
      memory.apply_loads(Vec3::Zero());
      worst = std::max(worst, std::abs(memory.displacement()[1] - kShape * swung(to_seconds(t - 1s)).first));
    }
    CHECK(worst < 1e-5 * kShape * 0.01);
  }
}

TEST_CASE("modal memory: a force on the tool pushes the surface the other way, at last by 1 / w^2") {
  const Triangle triangle;
  ModalMemory memory;
  REQUIRE(memory.place_near(triangle.model, Vec3::Zero()));
  REQUIRE(memory.take(triangle.published(0, 0), 0s, Vec3::Zero()));
  const std::array loads{VertexLoad{0, Vec3(0, -1, 0)}, VertexLoad{1, Vec3(0, -1, 0)}};
  REQUIRE(memory.carry(triangle.model, loads));
  for (Time t = 2ms; t < 10s; t += 2ms) {
    memory.advance(t);
    memory.apply_loads(Vec3(0, 2, 0));  // N, on the tool
  }
  CHECK(memory.displacement()[1] == Approx(-2 * kShape * kShape / (kW * kW)).epsilon(1e-4));
}

namespace {

/// How far off a memory that began with an error is, at most, once the first sample has told it better, m.
double worst_once_published(const Triangle& triangle, Time delay, Time period, bool requested_before) {
  ModalMemory memory;
  REQUIRE(memory.place_near(triangle.model, Vec3::Zero()));
  REQUIRE(memory.take(triangle.published(0.013, 0.1), 0s, Vec3::Zero()));  // wrong: it is at 0.01, at rest
  Time sampled = 30ms;
  double worst = 0;
  const auto tick = [&](Time t) {
    memory.advance(t);
    memory.apply_loads(Vec3::Zero());
  };
  for (Time t = 2ms; t < 1s; t += 2ms) {
    if (t == sampled + delay) {
      if (requested_before) tick(t);
      const auto [q, v] = swung(to_seconds(sampled));
      REQUIRE(memory.take(triangle.published(q, v), sampled, Vec3::Zero()));
      sampled += period;
    }
    tick(t);
    const double off = std::abs(memory.displacement()[1] - kShape * swung(to_seconds(t)).first);
    if (t > 30ms + delay) worst = std::max(worst, off);
  }
  return worst;
}

}  // namespace

TEST_CASE("modal memory: an error is set right by the first sample that tells of it, and counted once") {
  const Triangle triangle;
  for (const Time delay : {10ms, 36ms, 80ms, 110ms}) {
    // Up to a sample a tick: then some tell of the very tick at which another one came.
    for (const Time period : {30ms, 10ms, 4ms, 2ms}) {
      CAPTURE(delay.count(), period.count());
      CHECK(worst_once_published(triangle, delay, period, false) < 1e-4 * kShape * 0.01);
      // Who blends asks a law before it hears the sample, and again afterwards.
      CHECK(worst_once_published(triangle, delay, period, true) < 1e-4 * kShape * 0.01);
    }
  }
}

namespace {

/// q and q' at time t (s), from rest, under a load of `rate` t: the closed form (particular solution and free
/// motion).
std::pair<double, double> ramped(double t, double rate) {
  const double w2 = kW * kW, g = kDamping / 2, r = std::sqrt(w2 - g * g), e = std::exp(-g * t);
  const double q0 = kDamping / (w2 * w2), v0 = -1 / w2;  // of the free motion, for a rate of 1
  const double c = std::cos(r * t), s = std::sin(r * t), b = (v0 + g * q0) / r;
  const double q = t / w2 - kDamping / (w2 * w2) + e * (q0 * c + b * s);
  const double v = 1 / w2 + e * ((b * r - g * q0) * c - (q0 * r + g * b) * s);
  return {rate * q, rate * v};
}

}  // namespace

TEST_CASE("modal memory: loads of other tools that grow evenly drive it as the closed form") {
  const Triangle triangle;
  constexpr double kRate = 40;  // N/sqrt(kg)/s
  for (const Time delay : {0ms, 36ms, 80ms}) {
    CAPTURE(delay.count());
    ModalMemory memory;
    REQUIRE(memory.place_near(triangle.model, Vec3::Zero()));
    Time sampled = 0ms;
    double before = 0, worst = 0;
    for (Time t = 0ms; t < 600ms; t += 2ms) {
      if (t == sampled + delay) {
        const auto [q, v] = ramped(to_seconds(sampled), kRate);
        Surface surface = triangle.published(q, v);
        surface.modal_loads.count = 1;
        surface.modal_loads.load[0] = static_cast<float>(kRate * to_seconds(sampled));
        REQUIRE(memory.take(surface, sampled, Vec3::Zero()));
        sampled += 30ms;
      }
      if (!memory.known()) continue;
      memory.advance(t);
      memory.apply_loads(Vec3::Zero());
      const double off = std::abs(memory.displacement()[1] - kShape * ramped(to_seconds(t), kRate).first);
      // The next samples have no tick of their time to compare; and from no load to one is no trend yet.
      (t < 120ms + delay ? before : worst) = std::max(t < 120ms + delay ? before : worst, off);
    }
    const double moved = kShape * ramped(0.6, kRate).first;
    CAPTURE(before, worst, moved);
    CHECK(before > 5e-3 * moved);
    CHECK(worst < 1e-3 * moved);
  }
}

TEST_CASE("modal memory: amplitudes of no organ, an unknown spectrum, or a long silence: it knows nothing") {
  const Triangle triangle;
  ModalMemory memory;
  CHECK_FALSE(memory.take(triangle.published(0.01, 0), 0s, Vec3::Zero()));  // it stands nowhere
  REQUIRE(memory.place_near(triangle.model, Vec3::Zero()));
  CHECK_FALSE(memory.take(triangle.published(1000, 0), 0s, Vec3::Zero()));
  CHECK_FALSE(memory.known());
  REQUIRE(memory.place_near(triangle.model, Vec3::Zero()));
  REQUIRE(memory.take(triangle.published(0.01, 0), 0s, Vec3::Zero()));
  memory.advance(299ms);
  CHECK(memory.known());
  memory.advance(700ms);
  CHECK_FALSE(memory.known());
  const SurfaceModel nothing;
  Surface unknown = triangle.published(0.01, 0);
  unknown.model = &nothing;
  REQUIRE(memory.place_near(triangle.model, Vec3::Zero()));
  CHECK_FALSE(memory.take(unknown, 1s, Vec3::Zero()));
}

TEST_CASE("modal memory: neither ticks nor samples allocate") {
  const Triangle triangle;
  ModalMemory memory;
  const test::AllocationGuard guard;
  memory.place_near(triangle.model, Vec3::Zero());
  for (Time t = 2ms; t < 1s; t += 2ms) {
    if (t.count() % 30'000'000 == 0) memory.take(triangle.published(0.01, 0), t - 20ms, Vec3::Zero());
    memory.advance(t);
    memory.apply_loads(Vec3(0, 1, 0));
  }
  const std::array loads{VertexLoad{1, Vec3(0, -1, 0)}};
  for (Time t = 1s; t < 2s; t += 2ms) {  // and where it relaxes
    memory.place_near(triangle.model, Vec3::Zero());
    if (t.count() % 30'000'000 == 0) memory.take(triangle.published(0.01, 0, 0.001), t - 20ms, Vec3::Zero());
    memory.advance(t);
    memory.apply_loads(Vec3(0, 1, 0), loads);
  }
  CHECK(memory.known());
  CHECK(guard.count() == 0);
}
