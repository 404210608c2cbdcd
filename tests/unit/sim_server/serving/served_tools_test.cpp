#include "sim_server/serving/served_tools.h"

#include "sim_server/mesh/shapes.h"
#include "sim_server/models/rigid.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// Two tools of 5 mm over a wall at y = 0 that answers with 1000 N/m; held in the sessions 7 and 8.
struct Served {
  Simulation simulation{scene(), grid_block({-0.05, 0, 0.05}, {-0.05, 0}, {-0.05, 0, 0.05})};
  ServedTools tools{simulation};
  std::vector<SessionInput> inputs{2};

  static Scene scene() {
    Scene scene;
    scene.deformation.model = "rigid";
    scene.deformation.where = "test";
    scene.deformation.of<RigidSettings>().stiffness = 1000;
    scene.tools.resize(2);
    return scene;
  }
  Served() {
    hold(0, 7, 0.004);
    hold(1, 8, 0.003);
  }
  void hold(std::size_t tool, std::uint64_t session, double y) {
    inputs[tool] = {session, {.tool = static_cast<std::uint8_t>(tool), .tick = 5}, true};
    inputs[tool].state.p_W = {tool == 0 ? -0.02 : 0.02, y, 0.003};
  }
  std::span<const ServedTools::Outcome> step() { return tools.step(inputs, 0.03); }
  double newton(std::size_t tool) { return step()[tool].force.force[1]; }
};

}  // namespace

TEST_CASE("served tools: each session is answered with the force of its own tool") {
  Served served;
  const auto outcomes = served.step();
  REQUIRE(outcomes[0].answer);
  REQUIRE(outcomes[1].answer);
  CHECK(outcomes[0].answer->tool == 0);
  CHECK(outcomes[1].answer->tool == 1);
  CHECK(outcomes[0].answer->f_W[1] == Approx(1).epsilon(1e-3));
  CHECK(outcomes[1].answer->f_W[1] == Approx(2).epsilon(1e-3));
  CHECK(outcomes[1].answer->p_W == served.inputs[1].state.p_W);
}

TEST_CASE("served tools: only a fresh pose gets an answer, numbered in its own session") {
  Served served;
  served.step();
  served.inputs[0].fresh = false;
  const auto outcomes = served.step();
  CHECK_FALSE(outcomes[0].answer);
  CHECK(outcomes[0].force.force[1] == Approx(1).epsilon(1e-3));
  REQUIRE(outcomes[1].answer);
  CHECK(outcomes[1].answer->number == 2);
  served.inputs[0].fresh = true;
  CHECK(served.step()[0].answer->number == 2);
  served.hold(1, 9, 0.003);
  const auto next = served.step();
  CHECK(next[0].answer->number == 3);
  CHECK(next[1].answer->number == 1);
}

TEST_CASE("served tools: a session that ends and a device that is lost lift their own tool only") {
  Served served;
  served.step();
  served.inputs[0] = {};
  auto outcomes = served.step();
  CHECK(outcomes[0].force.contacts == 0);
  CHECK_FALSE(outcomes[0].answer);
  CHECK(outcomes[1].force.force[1] == Approx(2).epsilon(1e-3));
  served.hold(0, 10, 0.004);
  served.inputs[1].state.flags = protocol::ToolState::kDeviceLost;
  outcomes = served.step();
  CHECK(outcomes[0].force.force[1] == Approx(1).epsilon(1e-3));
  REQUIRE(outcomes[1].answer);
  CHECK(outcomes[1].answer->f_W == Vec3::Zero());
  CHECK(outcomes[1].answer->flags == 0);
}

TEST_CASE("served tools: a tool that changes hands does not travel from one to the other") {
  Served served;
  served.hold(0, 7, 0.05);
  served.step();
  served.hold(0, 11, -0.045);  // inside; from above it would have been dragged down, 5 cm deep
  CHECK(std::abs(served.newton(0)) < 20);
  CHECK(served.newton(1) == Approx(2).epsilon(1e-3));
}

TEST_CASE(
    "served tools: after a gap in its states a tool enters, and does not follow the jump through the organ") {
  Served served;
  const auto come = [&](double t, double x, double y, std::uint16_t flags = 0) {
    SessionInput& input = served.inputs[0];
    input.state.t_ns = from_seconds(t).count();
    input.state.p_W = {x, y, 0.003};
    input.state.flags = flags;
    input.follow(input.state);
  };
  // From beside the block to within: from its right, along x, the tool would hang 0.05 m deep in its side.
  const auto jump = [&](double gap, std::uint16_t flags) {
    for (int i = 0; i < 10; ++i) come(0.01 * i, 0.06, -0.02);
    served.step();
    if (flags != 0) come(0.09 + 0.5 * gap, 0.06, -0.02, flags);
    come(0.09 + gap, 0.0, -0.003);
    const Vec3 force = served.step()[0].force.force;
    served.hold(0, served.inputs[0].session + 2, 0.05);
    served.step();
    return force;
  };
  const Vec3 followed = jump(0.1, 0), entered = jump(0.101, 0),
             lost = jump(0.05, protocol::ToolState::kDeviceLost);
  CAPTURE(followed.transpose(), entered.transpose());
  // Entered, it stands on the nearest wall, the top: 1000 N/m, pressed by 3 mm and its radius of 5 mm.
  CHECK(entered[1] == Approx(8).epsilon(1e-3));
  CHECK(std::abs(entered[0]) < 1e-3);
  CHECK((lost - entered).norm() < 1e-9);
  CHECK((followed - entered).norm() > 1);
}

TEST_CASE("served tools: no tangent is made that nobody asked for, and the force is the same without") {
  Served asks, asks_not;
  asks.inputs[0].state.flags |= protocol::ToolState::kRequestsTangent;
  asks.step(), asks_not.step();
  const ToolForce &with = asks.simulation.tool(0).force(), &without = asks_not.simulation.tool(0).force();
  REQUIRE(with.contacts > 0);
  CHECK(with.tangent.norm() > 10);
  CHECK(without.tangent == Mat3::Zero());
  CHECK(with.force == without.force);
}

TEST_CASE("served tools: while it is paused a session hears its last sample again, with numbers that rise") {
  Served served;
  const protocol::ForceSample last = *served.step()[0].answer;
  for (std::uint64_t number = 2; number < 5; ++number) {
    const auto again = served.tools.paused(0, served.inputs[0]);
    REQUIRE(again);
    CHECK(again->number == number);
    CHECK(again->flags == (last.flags | protocol::ForceSample::kPaused));
    CHECK(again->f_W == last.f_W);
    CHECK(again->tool_tick == last.tool_tick);
  }
  const protocol::ForceSample after = *served.step()[0].answer;
  CHECK(after.number == 5);
  CHECK((after.flags & protocol::ForceSample::kPaused) == 0);
  CHECK(served.inputs[1].session == 8);
}

TEST_CASE("served tools: who comes while it is paused is told so, and goes on from these numbers") {
  Served served;
  served.step();
  served.hold(0, 9, 0.004);
  const auto first = served.tools.paused(0, served.inputs[0]);
  REQUIRE(first);
  CHECK(first->number == 1);
  CHECK(first->f_W == Vec3::Zero());
  CHECK(first->p_W == served.inputs[0].state.p_W);
  CHECK((first->flags & protocol::ForceSample::kPaused) != 0);
  CHECK(served.tools.paused(0, served.inputs[0])->number == 2);
  CHECK(served.step()[0].answer->number == 3);
  served.inputs[0] = {};
  CHECK_FALSE(served.tools.paused(0, served.inputs[0]));
}

TEST_CASE("served tools: nothing happens while nobody holds any, and a step does not allocate") {
  Served served;
  served.step();
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    served.step();
    served.inputs[1] = {};
    served.step();
    allocations = guard.count();
  }
  CHECK(allocations == 0);
  served.inputs[0] = {};
  CHECK(served.step().empty());
}

TEST_CASE("served tools: samples that did not settle are counted for each session") {
  Served served;
  std::uint64_t flagged = 0;
  const auto press = [&](double y) {
    served.hold(0, 7, y);
    const auto outcomes = served.step();
    flagged += (outcomes[0].answer->flags & protocol::ForceSample::kFlagged) != 0 ? 1 : 0;
    CHECK(outcomes[0].flagged_samples == flagged);
    CHECK(outcomes[1].flagged_samples == 0);
  };
  for (const double y : {0.004, 1e5, 1e5, 0.004, 0.003}) press(y);  // beyond the world, and back
  CHECK(flagged >= 2);
  served.hold(0, 9, 0.004);  // another hand
  CHECK(served.step()[0].flagged_samples == 0);
}
