// Tools on every deformation model: the stiffness that is sent to clients, the force at rest, and the work of
// a tool.
#include "sim_server/serving/served_tools.h"
#include "tests/support/catch.h"
#include "tests/support/contract.h"
#include "tests/support/model_bench.h"
#include "tests/support/soft_block.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kPeriod = 1.0 / 30;

bool publishes_tangents(const ModelCase& choice) {
  return !exempt(choice, "tangents");
}

/// `little_block`, but for the last bits of its vertices.
TetMesh block_for(const ModelCase& choice) {
  const int n = choice.element == ElementKind::kQuadratic ? 4 : 6;
  return grid_block(lines(-0.015, 0.015, n), lines(-0.012, 0, n / 2), lines(-0.015, 0.015, n));
}
/// Under a sphere of 5 mm.
Scene scene_for(const ModelCase& choice, double friction = 0) {
  Scene scene = little_block_scene();
  choice.choose(scene);
  scene.tools[0].shape.friction = friction;
  scene.rate_hz = 1 / kPeriod;
  return scene;
}

/// A tool goes down aslant in six periods, drags along in twelve more by less than a stride each, waits, and
/// goes to `last`.
struct Direction {
  Vec3 last = Vec3::Zero();
  int held = 0;
  double friction = 0;
  Vec3 drag = Vec3::Zero();
  int steps() const { return 6 + (drag.isZero() ? 0 : 12) + held; }
  Vec3 place(int step) const {
    const double way = 0.0003 * std::min(step, 6);
    if (step == steps()) return last;
    return Vec3(0.001 + way, 0.0048 - way, 0.0015) + std::clamp(step - 6, 0, 12) * drag;
  }
};

/// What the server answers to that in the end.
protocol::ForceSample answer_to(const ModelCase& choice, const Direction& way,
                                ToolForce* rendered = nullptr) {
  Simulation simulation(scene_for(choice, way.friction), block_for(choice));
  ServedTools served(simulation);
  std::vector<SessionInput> inputs{{7, {.flags = protocol::ToolState::kRequestsTangent}, true}};
  protocol::ToolState& state = inputs[0].state;
  for (int i = 0; i <= way.steps(); ++i) {
    ++state.tick;
    state.t_ns += 33'333'333;
    state.p_W = way.place(i);
    const ServedTools::Outcome& outcome = served.step(inputs, kPeriod).front();
    if (i < way.steps()) continue;
    if (rendered != nullptr) *rendered = outcome.force;
    return *outcome.answer;
  }
  return {};
}

/// The slope of that force over the last place, by differences of `step` (m).
Mat3 slope_of(const ModelCase& choice, Direction way, double step) {
  const Vec3 place = way.last;
  Mat3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    way.last = place + step * Vec3::Unit(axis);
    const Vec3 more = answer_to(choice, way).f_W;
    way.last = place - step * Vec3::Unit(axis);
    slope.col(axis) = (more - answer_to(choice, way).f_W) / (2 * step);
  }
  return slope;
}

}  // namespace

CONTRACT("a model that knows no compliance of later tells clients no tangents, in contact and before it",
         ModelCase, choice, model_cases([](const ModelCase& c) { return !publishes_tangents(c); })) {
  for (const Vec3& place : {Vec3(0.003, 0.0030, 0.0015), Vec3(0.003, 0.0052, 0.0015)}) {
    ToolForce rendered;
    const protocol::ForceSample sample = answer_to(choice, {.last = place}, &rendered);
    CHECK((rendered.contacts > 0) == (place.y() < 0.005));
    CHECK((sample.flags & (protocol::ForceSample::kHasTangent | protocol::ForceSample::kHasAhead)) == 0);
  }
}

CONTRACT(
    "the stiffness sent to the client is the slope of the server's own force over the sample "
    "interval",
    ModelCase, choice, model_cases(publishes_tangents)) {
  const Direction way{.last = Vec3(0.0028, 0.0030, 0.0015), .held = held_until_fresh(choice)};
  ToolForce rendered;
  const Mat3 sent = answer_to(choice, way, &rendered).at_tool.tangent;
  REQUIRE(rendered.contacts > 0);
  REQUIRE_FALSE(rendered.flagged);
  const Mat3 slope = slope_of(choice, way, 1e-6);
  CAPTURE(sent, slope, (sent - slope).norm() / slope.norm());
  CHECK((sent - slope).norm() < (exempt(choice, "slope in motion") ? 1e-2 : 1e-3) * slope.norm());
}

// Of laws that are not linear the factor is of where the body was one look before, or, where the background
// makes it, some steps before.
CONTRACT("in motion too the stiffness sent is that slope, but for the age of its factor", ModelCase, choice,
         model_cases([](const ModelCase& c) { return exempt(c, "slope in motion"); })) {
  const Direction way{.last = Vec3(0.0028, 0.0030, 0.0015)};
  const Mat3 sent = answer_to(choice, way).at_tool.tangent, slope = slope_of(choice, way, 1e-6);
  CAPTURE(sent, slope, (sent - slope).norm() / slope.norm());
  CHECK((sent - slope).norm() < (choice.solver == ModelCase::Solver::kDirect ? 0.06 : 0.15) * slope.norm());
}

// With friction the force depends on the way, and where the tool slides its slope is not symmetric. What is
// sent is the part of it that stores energy, of the last stride: the whole way of a slow tool.
CONTRACT("with friction the stiffness sent is that of a tool that sticks, or slides on", ModelCase, choice,
         model_cases(publishes_tangents)) {
  const Vec3 drag(2e-5, 5e-6, 0);
  for (const bool slides : {false, true}) {
    DYNAMIC_SECTION((slides ? "slides" : "sticks")) {
      Direction way{.held = std::max(1, held_until_fresh(choice)), .friction = 0.3, .drag = drag};
      way.last = way.place(way.steps() - 1) + (slides ? drag : Vec3(-drag));
      ToolForce rendered;
      const Mat3 sent = answer_to(choice, way, &rendered).at_tool.tangent;
      REQUIRE(rendered.contacts > 0);
      REQUIRE_FALSE(rendered.flagged);
      const Mat3 slope = slope_of(choice, way, 1e-7), stores = 0.5 * (slope + slope.transpose());
      CAPTURE(sent, slope, (sent - stores).norm() / stores.norm());
      CHECK((sent - stores).norm() < (exempt(choice, "slope in motion") ? 1e-2 : 1e-3) * stores.norm());
      CHECK(((slope - stores).norm() > 0.05 * stores.norm()) == slides);
    }
  }
}

CONTRACT("a tool that holds tissue where it rests feels nothing, and nothing moves", ModelCase, choice,
         model_cases()) {
  Scene scene = scene_for(choice);
  const Vec3 place(0.001, 0.005, 0.0005);
  scene.tools[0].grasp_place = place;
  Simulation simulation(scene, block_for(choice));
  for (int i = 0; i < 10; ++i) {
    const ToolForce rendered = simulation.step(place, kPeriod);
    REQUIRE(rendered.contacts > 0);
    CHECK(rendered.force.norm() < 1e-12);
  }
  CHECK(largest_difference(simulation.positions(), simulation.rest()) < 1e-15);
  CHECK(simulation.step(place + Vec3(0, 1e-4, 0), kPeriod).force[1] < -1e-3);
}

CONTRACT("a tool that presses and lets go never gets out more work than it put in", ModelCase, choice,
         model_cases()) {
  Simulation simulation(scene_for(choice), block_for(choice));
  double work = 0, most = 0, least = 0;
  Vec3 before(0.001, 0.0052, 0.0015);
  for (int i = 0; i <= 40; ++i) {
    const double deepest = exempt(choice, "deep press") ? 0.0014 : 0.0027,
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
