#include "sim_server/simulation/simulation.h"

#include "common/contact/simplex_distance.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDt = 1e-3;

/// Height of the liver's upper skin at (x, z), by the triangles themselves.
double height(const Simulation& simulation, double x, double z) {
  double top = -1;
  const auto at = [&](int corner) -> const Vec3& {
    return simulation.mesh().vertices[simulation.surface().vertices[corner]];
  };
  for (const Triangle& t : simulation.surface().triangles) {
    const Vec3 &a = at(t[0]), &b = at(t[1]), &c = at(t[2]);
    const double area = (b[0] - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (b[2] - a[2]);
    const double v = ((x - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (z - a[2])) / area;
    const double w = ((b[0] - a[0]) * (z - a[2]) - (x - a[0]) * (b[2] - a[2])) / area;
    if (v >= 0 && w >= 0 && v + w <= 1) top = std::max(top, a[1] + v * (b[1] - a[1]) + w * (c[1] - a[1]));
  }
  return top;
}

Vec3 on_liver(const Simulation& simulation, double x, double z, double depth) {
  return {x, height(simulation, x, z) + 0.005 - depth, z};
}

}  // namespace

TEST_CASE(
    "sliding over the shipped liver at 10 mm/s does not jerk: steps of at most 2 % of the mean force at 1 "
    "kHz") {
  Simulation liver(test::liver_scene());
  for (const double depth : {0.001, 0.003, 0.006}) {
    double largest = 0, sum = 0;
    int count = 0, flagged = 0;
    Vec3 before = Vec3::Zero();
    test::lift_tools(liver);
    for (double x = -0.06; x < 0.015; x += 1e-5) {
      const ToolForce force = liver.step(on_liver(liver, x, 0.004, depth), kDt);
      if (count > 0) largest = std::max(largest, (force.force - before).norm());
      before = force.force;
      sum += force.force.norm();
      flagged += force.flagged ? 1 : 0;
      ++count;
    }
    CAPTURE(depth, largest, sum / count);
    CHECK(sum / count > 0.1);
    CHECK(largest <= 0.02 * sum / count);
    CHECK(flagged == 0);
  }
}

TEST_CASE("the tangent agrees with finite differences of the force to 1e-6") {
  Simulation liver(test::liver_scene());
  test::Random random(8);
  int checked = 0;
  for (int i = 0; i < 30; ++i) {
    const Vec3 p = on_liver(liver, random.between(-0.05, 0.01), random.between(-0.01, 0.02),
                            random.between(0.001, 0.004));
    test::lift_tools(liver);
    const ToolForce force = liver.step(p, kDt);
    constexpr double kStep = 1e-7;
    Mat3 difference;
    bool same_contacts = force.contacts > 0;
    for (int axis = 0; axis < 3; ++axis) {
      const ToolForce ahead = liver.step(p + kStep * Vec3::Unit(axis), kDt);
      const ToolForce behind = liver.step(p - kStep * Vec3::Unit(axis), kDt);
      same_contacts = same_contacts && ahead.contacts == force.contacts && behind.contacts == force.contacts;
      difference.col(axis) = (ahead.force - behind.force) / (2 * kStep);
    }
    if (!same_contacts) continue;
    ++checked;
    CHECK((force.tangent - difference).norm() < 1e-6 * difference.norm());
  }
  CHECK(checked >= 20);
}

TEST_CASE("out of contact the force is exactly zero and the tissue exactly at rest") {
  Simulation liver(test::liver_scene());
  const std::uint64_t rest = liver.state_hash();
  liver.step(on_liver(liver, -0.02, 0, 0.004), kDt);
  CHECK(liver.state_hash() != rest);
  const ToolForce force = liver.step(on_liver(liver, -0.02, 0, -0.001), kDt);
  CHECK(force.force == Vec3::Zero());
  CHECK(force.contacts == 0);
  CHECK(liver.state_hash() == rest);
}

TEST_CASE("a tool that jumps 25 mm into the organ is held as if it had been pushed there") {
  Simulation jumped(test::liver_scene()), pushed(test::liver_scene());
  const Vec3 above = on_liver(jumped, -0.02, 0, -0.02), within = on_liver(jumped, -0.02, 0, 0.005);
  jumped.step(above, kDt);
  const ToolForce at_once = jumped.step(within, kDt);
  for (int i = 0; i <= 100; ++i) pushed.step(above + i / 100.0 * (within - above), kDt);
  CHECK(at_once.force[1] > 0.1);
  CHECK((at_once.force - pushed.step(within, kDt).force).norm() < 1e-6);
}

TEST_CASE("a tool that begins inside the organ is pushed out through the nearest surface") {
  Simulation liver(test::liver_scene());
  const ToolForce force = liver.step(on_liver(liver, -0.02, 0, 0.009), kDt);
  CHECK(force.force.allFinite());
  CHECK(force.force[1] > 0.3);
}

TEST_CASE("a wild position gives no force and says so, and the tool enters afresh") {
  Simulation liver(test::liver_scene());
  const Vec3 place = on_liver(liver, -0.02, 0, 0.003), good = liver.step(place, kDt).force;
  for (const double implausible : {std::nan(""), std::numeric_limits<double>::infinity(), 1e30}) {
    const ToolForce given_up = liver.step(Vec3(0, implausible, 0), kDt);
    CHECK(given_up.flagged);
    CHECK(given_up.force == Vec3::Zero());
    CHECK((liver.step(place, kDt).force - good).norm() < 1e-9);
  }
}

TEST_CASE("the tool on a fixed vertex feels a wall no harder than the stiffest tissue around") {
  Simulation liver(test::liver_scene());
  // The lowest, rearmost vertex is fixed; push it from behind.
  Vec3 fixed = liver.mesh().vertices.front();
  for (const int v : liver.surface().vertices) {
    if (liver.mesh().vertices[v][2] < fixed[2]) fixed = liver.mesh().vertices[v];
  }
  liver.step(fixed - Vec3(0, 0, 0.0051), kDt);
  const ToolForce force = liver.step(fixed - Vec3(0, 0, 0.004), kDt);
  CHECK(force.force[2] < -0.01);
  CHECK(force.force.norm() < 2);
  CHECK(liver.step(fixed - Vec3(0, 0, 0.006), kDt).force == Vec3::Zero());
}

TEST_CASE("a tool that tears through and away leaves the tissue behind") {
  Simulation liver(test::liver_scene());
  const Vec3 from(-0.13, 0, 0.02), to(0.3, 0.3, 0.3);
  for (int i = 0; i <= 60; ++i) liver.step(from + i / 60.0 * (Vec3(0.12, 0, 0.03) - from), kDt);
  liver.step(to, kDt);
  CHECK(liver.step(to, kDt).force == Vec3::Zero());
}

TEST_CASE("any path at all gives finite forces within a bounded number of iterations") {
  Simulation liver(test::liver_scene());
  test::Random random(14);
  int most = 0;
  for (int i = 0; i < 200; ++i) {
    const ToolForce force = liver.step(random.vector(0.1), kDt);
    REQUIRE(force.force.allFinite());
    REQUIRE(force.tangent.allFinite());
    most = std::max(most, force.iterations);
  }
  CHECK(most <= 600);
}

TEST_CASE("a step in contact does not allocate") {
  Simulation liver(test::liver_scene());
  liver.step(on_liver(liver, -0.02, 0, 0.003), kDt);
  std::size_t allocations = 1;
  const Vec3 a = on_liver(liver, -0.021, 0.001, 0.005), b = on_liver(liver, -0.021, 0.001, -0.01);
  {
    const test::AllocationGuard guard;
    liver.step(a, kDt);
    liver.step(b, kDt);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}

TEST_CASE("the same path gives the same bits") {
  Simulation one(test::liver_scene()), two(test::liver_scene());
  for (double x = -0.04; x < -0.03; x += 1e-3) {
    one.step(on_liver(one, x, 0, 0.004), kDt);
    two.step(on_liver(two, x, 0, 0.004), kDt);
  }
  CHECK(one.state_hash() == two.state_hash());
}

TEST_CASE("a long tool on a surface finer than it has room for: finite, settled, and outside the tissue") {
  // 128 x 12 x 16 mm, top at y = 0, held at the bottom, vertices 2 mm apart on top; a capsule of 2 mm along
  // it.
  std::vector<double> x, z;
  for (int i = -32; i <= 32; ++i) x.push_back(0.002 * i);
  for (int i = -4; i <= 4; ++i) z.push_back(0.002 * i);
  constexpr double kRadius = 0.002, kLength = 0.12;
  Scene scene = test::scene_of({.young_modulus = 1e4, .poisson_ratio = 0.4},
                               {Vec3(-1, -1, -1), Vec3(1, -0.0119, 1)}, kRadius);
  scene.tools[0].shape.length = kLength;
  scene.tools[0].reach = Box{Vec3(-1, -1e-3, -1), Vec3(1, 1e-3, 1)};
  Simulation block(scene, grid_block(x, {-0.012, -0.008, -0.004, 0}, z));
  const Quat level = test::turn_between(Vec3::UnitZ(), Vec3::UnitX());
  const auto axis = [](double depth) { return Vec3(-kLength / 2, kRadius - depth, 0.0003); };
  ToolForce force;
  for (double depth = -0.002; depth < 0.0021; depth += 0.0005) {
    force = block.step({axis(depth), level}, kDt);
    REQUIRE(force.force.allFinite());
    CHECK_FALSE(force.flagged);
  }
  CHECK(force.force[1] > 0.5);
  const Vec3 begin = axis(0.002), end = begin + Vec3(kLength, 0, 0);
  const auto at = block.positions();
  int near = 0;
  double nearest = 1;
  for (const Triangle& t : block.touchable(0)) {
    const double distance = segment_triangle_distance(begin, end, at[t[0]], at[t[1]], at[t[2]]);
    nearest = std::min(nearest, distance);
    near += distance <= 1.5 * kRadius ? 1 : 0;  // as the server gathers them
  }
  CHECK(near > block.tool(0).max_nodes());  // as many as triangles, and two
  CHECK(nearest == Approx(kRadius).margin(2e-9));
}
