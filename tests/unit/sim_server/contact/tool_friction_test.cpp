// Friction on the organ: strides, probes, several tools.
#include <cmath>
#include <optional>

#include "sim_server/mesh/shapes.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDt = 0.03, kRadius = 0.005, kMu = 0.3;

using Places = std::vector<std::optional<ToolPose>>;

Scene rubbed_scene(std::size_t tools, double friction, const std::string& model = "quasi_static") {
  Scene scene = test::wide_block_scene(tools, kRadius, model);
  for (auto& tool : scene.tools) tool.shape.friction = friction;
  return scene;
}

struct Block : Simulation {
  explicit Block(std::size_t tools = 1, double friction = kMu, const std::string& model = "quasi_static")
      : Simulation(rubbed_scene(tools, friction, model), test::wide_block()) {}
  std::vector<ToolForce> at(const Places& places) {
    const auto forces = Simulation::step(test::inputs(places), kDt);
    return {forces.begin(), forces.end()};
  }
};

Vec3 press(double x, double depth, double z = 0.0013) {
  return {x, kRadius - depth, z};
}

double relative(const Vec3& a, const Vec3& b) {
  return (a - b).norm() / b.norm();
}

}  // namespace

TEST_CASE("friction on a rigid organ: mu F_n against the slide, whatever the steps") {
  for (const double step : {1e-4, 1e-3, 1e-2}) {
    Block rigid(1, kMu, "rigid");
    ToolForce force;
    rigid.step(press(-0.02, -0.001), kDt);
    for (double x = -0.02; x <= 0.02; x += step) force = rigid.step(press(x, 0.002), kDt);
    CAPTURE(step);
    CHECK_FALSE(force.flagged);
    CHECK(force.force[1] == Approx(1.6).epsilon(1e-4));
    CHECK(force.force[0] == Approx(-kMu * 1.6).epsilon(1e-4));
  }
}

TEST_CASE("friction: a ball that rolls is not held back, one that spins is pushed, on a rigid organ") {
  // Over a plane at y = 0, by 1 mm in 20 steps: the point of contact slips by (1 - roll) of the way, less
  // what the contact gives way by before.
  constexpr double kWay = 0.001, kNormal = 1.6, kDepth = 0.002;
  for (const double roll : {0.0, 0.5, 1.0, 2.0}) {
    Block rigid(1, kMu, "rigid");
    std::vector<ToolInput> input(1);
    const auto at = [&](double x, double depth) {
      const double angle = -roll * x / kRadius;
      input[0].pose = ToolPose(press(x, depth), Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ())));
      return rigid.step(input, kDt)[0];
    };
    at(0, -0.001);
    at(0, kDepth);
    ToolForce force;
    for (int i = 1; i <= 20; ++i) force = at(kWay * i / 20, kDepth);
    CAPTURE(roll, force.force.transpose(), force.torque.transpose());
    const double right = std::clamp(-(1 - roll) * kWay * kNormal / kDepth, -kMu * kNormal, kMu * kNormal);
    CHECK_FALSE(force.flagged);
    CHECK(force.force[0] == Approx(right).margin(1e-3 * kMu * kNormal));
    CHECK(force.force[1] == Approx(kNormal).epsilon(1e-3));
    // About the centre: the arm is (0, -radius, 0).
    CHECK(force.torque[2] == Approx(kRadius * right).margin(1e-3 * kRadius * kMu * kNormal));
  }
}

TEST_CASE("friction: the way between two places is bent as the velocities say, wild ones hardly matter") {
  // Round an arc of 4 mm radius, 30 degrees a step, 2 mm deep.
  constexpr double kTurn = 0.5, kArc = 0.004;
  const auto at = [](double phi) { return press(kArc * std::cos(phi), 0.002, kArc * std::sin(phi)); };
  const auto velocity = [](double phi) -> Vec3 {
    return kArc * kTurn / kDt * Vec3(-std::sin(phi), 0, std::cos(phi));
  };
  Block truth, straight, bent, implausible;
  for (Block* block : {&truth, &straight, &bent, &implausible}) {
    block->step(press(kArc, -0.001, 0), kDt);
    block->step(at(0), kDt);
  }
  double by_line = 0, by_cubic = 0;
  for (int i = 1; i <= 12; ++i) {
    const double from = kTurn * (i - 1), to = kTurn * i;
    const Vec3 way = at(to) - at(from);
    Vec3 expected;
    for (int k = 1; k <= 60; ++k) expected = truth.step(at(from + kTurn * k / 60), kDt / 60).force;
    const Bend path{kDt * velocity(from) - way, kDt * velocity(to) - way},
        anything{1e200 * Vec3::UnitY(), i % 2 == 0 ? Vec3(1e300, 1e300, 1e300) : Vec3(0, std::nan(""), 0)};
    const Vec3 line = straight.step(at(to), kDt).force;
    by_line = std::max(by_line, relative(line, expected));
    by_cubic = std::max(by_cubic, relative(test::step(bent, at(to), {.bend = path}, kDt).force, expected));
    const ToolForce any = test::step(implausible, at(to), {.bend = anything}, kDt);
    CHECK_FALSE(any.flagged);
    CHECK(relative(any.force, line) < 0.1);
  }
  CAPTURE(by_line, by_cubic);
  CHECK(by_cubic < 0.5 * by_line);
}

TEST_CASE("friction: a tool at rest holds its force for as long as it stays") {
  Block organ;
  organ.step(press(0, -0.001), kDt);
  organ.step(press(0, 0.002), kDt);
  const Vec3 slid = organ.step(press(0.004, 0.002), kDt).force;
  Vec3 last = slid;
  for (int i = 0; i < 2000; ++i) last = organ.step(press(0.004, 0.002), kDt).force;
  CHECK(slid[0] < -0.05 * slid[1]);
  CHECK(relative(last, slid) < 1e-5);  // 1e-10 m/N of creep in each
}

TEST_CASE("friction: looking ahead changes nothing, bit by bit, and foretells the step itself") {
  Block plain, looked;
  test::Random random(5);
  Vec3 p = press(0, 0);
  for (int i = 0; i < 60; ++i) {
    p += random.vector(0.0015) - 0.0002 * Vec3::UnitY();
    p[1] = std::clamp(p[1], 0.0015, 0.0055);
    const Vec3 there = p;
    const auto ahead = looked.linearise(0, there, nullptr);
    const std::uint64_t before = looked.state_hash();
    looked.linearise(0, p + random.vector(0.004), nullptr);
    CHECK(looked.state_hash() == before);
    const ToolForce expected = plain.step(there, kDt), force = looked.step(there, kDt);
    CHECK(force.force == expected.force);
    CHECK(looked.state_hash() == plain.state_hash());
    if (i > 0 && expected.contacts > 0 && !expected.flagged) CHECK(ahead.f_W == expected.force);
  }
}

TEST_CASE("friction: one tool moves the tissue under another that rests, it is dragged, and returns") {
  Block two(2), alone;
  alone.step(press(-0.006, 0.002), kDt);
  const Vec3 before = two.at({press(-0.006, 0.002), {}})[0].force;
  CHECK(relative(before, alone.step(press(-0.006, 0.002), kDt).force) < 1e-6);
  // The other slides away from the first and carries tissue with it.
  two.at({press(-0.006, 0.002), press(0.007, 0.002)});
  for (int i = 0; i < 12; ++i) two.at({press(-0.006, 0.002), press(0.007 + 0.0005 * i, 0.002)});
  const auto after = two.at({press(-0.006, 0.002), press(0.013, 0.002)});
  CHECK_FALSE(after[0].flagged);
  CHECK(after[0].force[0] > before[0] + 0.002 * before[1]);
  const Vec3 remaining = two.at({press(-0.006, 0.002), {}})[0].force;
  CHECK(remaining.allFinite());
  CHECK(relative(remaining, before) < 0.1);
}

TEST_CASE("friction: tools that change places feel the same, whoever comes first") {
  Block two(2), swapped(2);
  std::vector<ToolForce> forces, others;
  // In steps of a stride each: between strides the tools move in turns, which costs 0.2 % at ten times that.
  for (int i = 0; i <= 120; ++i) {
    const double s = i / 120.0;
    const Vec3 a = press(-0.0065 + 0.002 * s, 0.0025 * std::min(1.0, 2 * s)),
               b = press(0.0065, 0.002 * std::min(1.0, 2 * s), 0.0013 + 0.002 * s);
    forces = two.at({a, b});
    others = swapped.at({b, a});
  }
  CHECK(forces[0].contacts > 0);
  CHECK(relative(forces[0].force, others[1].force) < 1e-4);
  CHECK(relative(forces[1].force, others[0].force) < 1e-4);
}

TEST_CASE("friction: a tool with, and one without, on one organ") {
  Scene mixed = rubbed_scene(2, 0);
  mixed.tools[1].shape.friction = kMu;
  Simulation simulation(mixed, test::wide_block());
  Block alone(1, kMu);
  Places places{{}, press(0, 0.002)};
  simulation.step(test::inputs(places), kDt);
  alone.step(*places[1], kDt);
  places[1] = press(0.004, 0.002);
  CHECK(simulation.step(test::inputs(places), kDt)[1].force == alone.step(*places[1], kDt).force);
  places = {press(0.004, 0.002), {}};
  const Vec3 smooth = simulation.step(test::inputs(places), kDt)[0].force;
  CHECK(smooth == Block(1, 0).step(press(0.004, 0.002), kDt).force);
}

TEST_CASE("friction: any path gives finite forces, in settled answers but for a few") {
  Block organ;
  test::Random random(3);
  int flagged = 0, touched = 0;
  Vec3 p = press(-0.01, 0);
  for (int i = 0; i < 500; ++i) {
    p += random.vector(0.003);
    p = p.cwiseMax(Vec3(-0.03, 0.0005, -0.01)).cwiseMin(Vec3(0.03, 0.01, 0.01));
    const ToolForce force = organ.step(p, kDt);
    REQUIRE(force.force.allFinite());
    flagged += force.flagged ? 1 : 0;
    touched += force.contacts > 0 ? 1 : 0;
  }
  CAPTURE(flagged, touched);
  CHECK(touched > 200);
  CHECK(flagged < 10);
}

TEST_CASE("friction: steps and looks ahead do not allocate, with two tools") {
  Block two(2);
  const std::vector<ToolInput> at_tool{{.pose = press(-0.006, 0.002)}, {.pose = press(0.006, 0.002)}},
      there{{.pose = press(-0.009, 0.002)}, {.pose = press(0.004, 0.003)}};
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    two.step(at_tool, kDt);
    two.step(there, kDt);
    two.linearise(0, press(-0.0095, 0.002), nullptr);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
