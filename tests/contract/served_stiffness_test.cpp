// Tools on every deformation model: the stiffness that is sent to clients, the force at rest, and the work of
// a tool.
#include "sim_server/served_tools.h"
#include "tests/support/catch.h"
#include "tests/support/model_bench.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kPeriod = 1.0 / 30;

/// A block of 30 x 12 x 30 mm, its top at y = 0, its bottom held, under a sphere of 5 mm.
TetMesh block() {
  return grid_block(lines(-0.015, 0.015, 6), lines(-0.012, 0, 3), lines(-0.015, 0.015, 6));
}
Scene block_scene(const ModelCase& choice) {
  Scene scene =
      scene_of({.young_modulus = 1e4, .poisson_ratio = 0.4}, {Vec3(-1, -1, -1), Vec3(1, -0.0119, 1)}, 0.005);
  choice.choose(scene);
  scene.rate_hz = 1 / kPeriod;
  return scene;
}

/// What the server answers to a tool that goes down aslant in six periods, waits `held` more, and goes to
/// `last`.
protocol::ForceSample answer_at(const ModelCase& choice, int held, const Vec3& last,
                                ToolForce* felt = nullptr) {
  Simulation simulation(block_scene(choice), block());
  ServedTools served(simulation);
  std::vector<ToolInput> inputs{{7, {.flags = protocol::ToolState::kWantsHere}, true}};
  protocol::ToolState& state = inputs[0].state;
  for (int i = 0; i <= 6 + held; ++i) {
    const bool is_last = i == 6 + held;
    const double way = 0.0003 * std::min(i, 6);
    ++state.tick;
    state.t_ns += 33'333'333;
    state.p_W = is_last ? last : Vec3(0.001 + way, 0.0048 - way, 0.0015);
    const ServedTools::Outcome& outcome = served.step(inputs, kPeriod).front();
    if (!is_last) continue;
    if (felt != nullptr) *felt = outcome.force;
    return *outcome.answer;
  }
  return {};
}

}  // namespace

TEST_CASE(
    "contract: the stiffness sent to the client is the slope of the server's own force over the sample "
    "interval") {
  const Vec3 place(0.0028, 0.0030, 0.0015);
  constexpr double kStep = 1e-6;  // m
  for (const ModelCase& choice : model_cases()) {
    const int held = choice.held_until_fresh();
    DYNAMIC_SECTION(choice.name()) {
      ToolForce felt;
      const protocol::ForceSample sample = answer_at(choice, held, place, &felt);
      REQUIRE(felt.contacts > 0);
      REQUIRE_FALSE(felt.flagged);
      const auto& t = sample.here.tangent;
      const Mat3 sent = (Mat3() << t[0], t[1], t[2], t[1], t[3], t[4], t[2], t[4], t[5]).finished();
      Mat3 slope;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 d = kStep * Vec3::Unit(axis);
        slope.col(axis) =
            (answer_at(choice, held, place + d).f_W - answer_at(choice, held, place - d).f_W) / (2 * kStep);
      }
      CAPTURE(sent, slope, (sent - slope).norm() / slope.norm());
      CHECK((sent - slope).norm() < (choice.linear() ? 1e-3 : 1e-2) * slope.norm());
    }
  }
}

TEST_CASE("contract: a tool that holds tissue where it rests feels nothing, and nothing moves") {
  for (const ModelCase& choice : model_cases()) {
    DYNAMIC_SECTION(choice.name()) {
      Scene scene = block_scene(choice);
      const Vec3 place(0.001, 0.005, 0.0005);
      scene.tools[0].grasp_place = place;
      Simulation simulation(scene, block());
      for (int i = 0; i < 10; ++i) {
        const ToolForce felt = simulation.step(place, kPeriod);
        REQUIRE(felt.contacts > 0);
        CHECK(felt.force.norm() < 1e-12);
      }
      CHECK(largest_difference(simulation.positions(), simulation.rest()) < 1e-15);
      CHECK(simulation.step(place + Vec3(0, 1e-4, 0), kPeriod).force[1] < -1e-3);
    }
  }
}

TEST_CASE("contract: a tool that presses and lets go never gets out more work than it put in") {
  for (const ModelCase& choice : model_cases()) {
    DYNAMIC_SECTION(choice.name()) {
      Simulation simulation(block_scene(choice), block());
      double work = 0, most = 0, least = 0;
      Vec3 before(0.001, 0.0052, 0.0015);
      for (int i = 0; i <= 40; ++i) {
        // Saint Venant and Kirchhoff's collapses under more.
        const double deepest = choice.law == ElasticLaw::kStVenantKirchhoff ? 0.0014 : 0.0027,
                     down = std::min({0.0002 * i, 0.0002 * (40 - i), deepest});
        const Vec3 p(0.001 + 5e-5 * i, 0.0052 - down, 0.0015);
        const Vec3 force = simulation.step(p, kPeriod).force;
        work -= force.dot(p - before);
        most = std::max(most, work);
        least = std::min(least, work);
        before = p;
      }
      CAPTURE(work, most, least);
      CHECK(most > 1e-5);
      CHECK(work >= 0);
      CHECK(least >= -1e-9 * most);
    }
  }
}
