#include "sim_server/simulation/tool_coupling.h"

#include "sim_server/simulation/simulation.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDt = 0.03;
const Vec3 kPlaces[] = {{-0.01, 0, 0}, {0.01, 0, 0}, {0.02, 0, 0.01}};

/// A wide block, of whose top tools hold a vertex each; tools with a small `radius` hold one.
Scene held_block(std::size_t tools, double radius) {
  Scene scene = test::wide_block_scene(tools, radius);
  for (std::size_t i = 0; i < tools; ++i) scene.tools[i].grasp_place = kPlaces[i];
  return scene;
}

struct Held : Simulation {
  explicit Held(std::size_t tools, double radius = 0.001)
      : Simulation(held_block(tools, radius), test::wide_block()) {}
  /// Each tool so far from where it grasped (m), at a velocity (m/s).
  std::span<const ToolAnswer> at(std::span<const Vec3> moved, std::span<const Vec3> velocities) {
    std::vector<ToolInput> inputs(moved.size());
    for (std::size_t i = 0; i < moved.size(); ++i) {
      inputs[i].pose = ToolPose(kPlaces[i] + moved[i]);
      inputs[i].v_W = velocities[i];
      inputs[i].request = {.tangent = true, .at_tool = true};
    }
    return step(inputs, kDt);
  }
};

/// What a law makes of an answer: the force on a tool that has gone on by `d`, a time `t` later.
Vec3 predicted(const ToolAnswer& answer, const Vec3& d, double t) {
  return answer.force + answer.at_tool->tangent * (d - t * answer.others->v_W);
}

}  // namespace

TEST_CASE("tools that hold linear tissue: each knows what it will feel, whichever of them move, and how") {
  const std::size_t tools = GENERATE(2, 3);
  Held block(tools);
  const std::vector<Vec3> still(tools, Vec3::Zero());
  std::vector<Vec3> moved{{0, 0.004, 0.001}, {0.002, 0.003, 0}, {0, 0.002, -0.001}};
  std::vector<Vec3> v{{0.01, -0.03, 0.02}, {-0.02, 0.05, 0.01}, {0.03, 0.02, 0}};
  moved.resize(tools), v.resize(tools);
  const auto answers = block.at(moved, v);
  const std::vector<ToolAnswer> then(answers.begin(), answers.end());
  const double t = 0.05;
  for (std::size_t i = 0; i < tools; ++i) moved[i] += t * v[i];
  const auto now = block.at(moved, still);
  for (std::size_t i = 0; i < tools; ++i) {
    REQUIRE(then[i].others);
    const double change = (now[i].force - then[i].force).norm();
    CHECK((predicted(then[i], t * v[i], t) - now[i].force).norm() < 1e-6 * change);
    // Whoever leaves the others out is far off.
    CHECK((then[i].force + then[i].tangent * t * v[i] - now[i].force).norm() > 0.02 * change);
  }
}

TEST_CASE("tools that hold several vertices each: what the others do is foretold to 15 % of it") {
  Held block(2, 0.006);  // at more than three radii
  std::vector<Vec3> moved{{0, 0.004, 0.001}, {0.002, 0.003, 0}};
  const std::vector<Vec3> still(2, Vec3::Zero()), v{Vec3::Zero(), {-0.02, 0.05, 0.01}};
  const ToolAnswer then = block.at(moved, v)[0];
  REQUIRE(then.contacts > 3);
  const double t = 0.05;
  moved[1] += t * v[1];
  const Vec3 now = block.at(moved, still)[0].force;
  CHECK((predicted(then, Vec3::Zero(), t) - now).norm() < 0.15 * (now - then.force).norm());
}

TEST_CASE("one tool alone, and one beside a tool that is lifted, is told of no other") {
  Held one(1), two(2);
  const Vec3 moved(0, 0.003, 0.001), v(0, 0.02, 0);
  const ToolAnswer alone = one.at({&moved, 1}, {&v, 1})[0];
  CHECK_FALSE(alone.others);
  std::vector<ToolInput> inputs(2);
  inputs[0] = {.pose = ToolPose(kPlaces[0] + moved), .v_W = v, .request = {.tangent = true, .at_tool = true}};
  const ToolAnswer beside = two.step(inputs, kDt)[0];
  CHECK_FALSE(beside.others);
  CHECK((beside.at_tool->tangent - alone.at_tool->tangent).norm() < 1e-9 * alone.at_tool->tangent.norm());
}

TEST_CASE("tools that are told of each other: a step does not allocate") {
  Held block(3);
  const std::vector<Vec3> moved{{0, 0.004, 0.001}, {0.002, 0.003, 0}, {0, 0.002, -0.001}};
  std::vector<ToolInput> inputs(3);
  for (std::size_t i = 0; i < 3; ++i)
    inputs[i] = {.pose = ToolPose(kPlaces[i] + moved[i]),
                 .v_W = {0.01, 0, 0},
                 .request = {.tangent = true, .at_tool = true}};
  block.step(inputs, kDt);
  const test::AllocationGuard guard;
  const auto answers = block.step(inputs, kDt);
  const std::size_t allocations = guard.count();
  CHECK(answers[0].others);
  CHECK(allocations == 0);
}

TEST_CASE(
    "two tools that press one place: no tangent is more than ten times that with the other's load held") {
  const Scene scene = test::wide_block_scene(2, 0.005);
  int settled = 0;
  for (const double spacing : {0.0, 1e-4, 5e-4, 1e-3, 2e-3, 4e-3}) {
    Simulation block(scene, test::wide_block());
    std::vector<ToolInput> inputs(2);
    for (int step = 0; step < 10; ++step) {
      for (std::size_t i = 0; i < 2; ++i)
        inputs[i] = {.pose = ToolPose(Vec3(i == 0 ? 0 : spacing, 0.0045 - 2e-4 * step, 0.001)),
                     .v_W = {0, -0.01, 0},
                     .request = {.tangent = true, .at_tool = true}};
      for (const ToolAnswer& answer : block.step(inputs, kDt)) {
        if (!answer.at_tool || answer.contacts == 0) continue;
        ++settled;
        CHECK(answer.at_tool->tangent.norm() <= 10 * answer.tangent.norm());
      }
    }
  }
  CHECK(settled > 10);
}

TEST_CASE("a tool whose velocity no hand has moves no surface under another") {
  Held block(2);
  const std::vector<Vec3> moved{{0, 0.004, 0.001}, {0.002, 0.003, 0}};
  const auto published = [&](const Vec3& v) {
    const std::vector<Vec3> velocities{v, Vec3::Zero()};
    const auto answer = block.at(moved, velocities)[1];
    return answer.others ? answer.others->v_W.norm() : 0;
  };
  published({0, 1, 0});
  CHECK(published({0, 1, 0}) > 1e-3);
  CHECK(published({0, 100, 0}) == 0);
}
