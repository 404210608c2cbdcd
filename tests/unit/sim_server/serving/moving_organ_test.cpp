// Organs whose supports move by prescription.
#include <fmt/format.h>
#include <numbers>

#include "common/error.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/served_tools.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kTau = 2 * std::numbers::pi;
const SupportMotion kBreath{Vec3(0.6, 0.8, 0), 0.005, 4};
const Vec3 kPressed(0.001, 0.0035, 0.002);  // 1.5 mm deep at rest

TetMesh block() {
  return test::soft_block({0.04, 0.016, 0.04}, {10, 4, 10});
}

/// A soft block, top at y = 0, on a bottom that moves as told; a tool of 5 mm. Of the models that have
/// inertia, steps of `dt` (s).
Scene block_scene(std::vector<SupportMotion> motions, std::string_view model = "quasi_static",
                  double dt = 0.05) {
  Scene scene = test::soft_block_scene(0.016);
  scene.fixed[0].motions = std::move(motions);
  scene.deformation.model = model;
  scene.rate_hz = 1 / dt;
  return scene;
}

/// All that follow their supports.
std::vector<std::string_view> models() {
  std::vector<std::string_view> names;
  for (const DeformationModelRow& row : models_without_cutting()) {
    if (row.deforms()) names.push_back(row.name);
  }
  return names;
}

Vec3 at(const SupportMotion& motion, double t) {
  return motion.amplitude * std::sin(kTau * t / motion.period + motion.phase) * motion.direction;
}
Vec3 speed_of(const SupportMotion& motion, double t) {
  return kTau / motion.period * motion.amplitude * std::cos(kTau * t / motion.period + motion.phase) *
         motion.direction;
}

}  // namespace

TEST_CASE("moving supports: a bar pulled at one end stretches evenly, the other end may move too") {
  // Without lateral contraction the field between two ends that move along x is linear in x, to the bit of
  // what linear elements give.
  const ElementKind element =
      GENERATE(ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic);
  TetMesh mesh = grid_block({0, 0.01, 0.025, 0.04}, {0, 0.01}, {0, 0.01, 0.02});
  Scene scene = test::scene_of({.young_modulus = 5e3, .poisson_ratio = 0, .element = element},
                               {Vec3(-1, -1, -1), Vec3(0, 1, 1)}, 0.005);
  scene.fixed.push_back({{Box{Vec3(0.04, -1, -1), Vec3(1, 1, 1)}, "", "test"}});
  scene.fixed[0].motions = {{Vec3::UnitX(), 0.001, 2.0, 0.3}};
  scene.fixed[1].motions = {{Vec3::UnitX(), 0.002, 3.0}, {Vec3::UnitX(), 0.0005, 0.7, 1.0}};
  Simulation bar(scene, mesh);
  double t = 0;
  for (const double dt : {0.0, 0.01, 0.4, 0.033}) {
    t += dt;
    bar.step(Vec3(0, 1, 0), dt);
    const double left = at(scene.fixed[0].motions[0], t)[0];
    const double right = at(scene.fixed[1].motions[0], t)[0] + at(scene.fixed[1].motions[1], t)[0];
    for (std::size_t v = 0; v < bar.positions().size(); ++v) {
      const Vec3& rest = bar.mesh().vertices[bar.surface().vertices[v]];
      const Vec3 expected = rest + (left + (right - left) * rest[0] / 0.04) * Vec3::UnitX();
      CHECK((bar.positions()[v] - expected).norm() < 1e-12);
    }
  }
}

TEST_CASE("moving supports: a common translation moves the body as one, at the velocity it has") {
  Simulation organ(block_scene({kBreath}), block());
  double t = 0;
  for (int i = 0; i < 20; ++i) {
    const ToolAnswer far = test::step(organ, Vec3(0, 1, 0), {.request = {.at_tool = true}}, 0.11);
    t += 0.11;
    for (std::size_t v = 0; v < organ.positions().size(); ++v) {
      const Vec3 rest = organ.mesh().vertices[organ.surface().vertices[v]];
      CHECK((organ.positions()[v] - rest - at(kBreath, t)).norm() < 1e-12);
    }
    CHECK((far.surface_v_W - speed_of(kBreath, t)).norm() < 1e-12);
  }
}

TEST_CASE("a tool that moves with the organ feels what it felt at rest, a resting organ has no velocity") {
  for (const std::string_view model : models()) {
    // The block's slowest frequency is 25 Hz: at a quarter of one, its inertia bends it by little.
    const double inertia = model == "quasi_static" ? 1e-6 : 0.005;
    Scene still = block_scene({}, model), breathing = block_scene({kBreath}, model);
    if (model == "implicit")  // one that looks again at where contact led
      still.material->law = breathing.material->law = ElasticLaw::kCorotational;
    Simulation resting(still, block()), moving(breathing, block());
    for (int i = 1; i <= 40; ++i) {
      const double t = 0.05 * i;
      const ToolInput asks{.request = {.at_tool = true}};
      const ToolAnswer right = test::step(resting, kPressed, asks, 0.05),
                       rendered = test::step(moving, kPressed + at(kBreath, t), asks, 0.05);
      CAPTURE(model, i);
      REQUIRE(right.force[1] > 0.1);
      CHECK((rendered.force - right.force).norm() < inertia * right.force.norm());
      CHECK_FALSE(rendered.flagged);
      CHECK((rendered.surface_v_W - speed_of(kBreath, t)).norm() <
            1e-12 + 0.2 * inertia * kTau / kBreath.period * kBreath.amplitude);
      CHECK(right.surface_v_W == Vec3::Zero());
    }
  }
}

TEST_CASE("friction does not feel a tool and an organ that go along together") {
  for (const std::string_view model : models()) {
    Scene scene = block_scene({kBreath}, model), still = block_scene({}, model);
    scene.tools[0].shape.friction = still.tools[0].shape.friction = 0.3;
    Simulation organ(scene, block()), resting(still, block());
    organ.step(kPressed, 0);
    resting.step(kPressed, 0);
    for (int i = 1; i < 40; ++i) {
      const ToolForce rendered = organ.step(kPressed + at(kBreath, 0.05 * i), 0.05),
                      right = resting.step(kPressed, 0.05);
      CAPTURE(model, i);
      REQUIRE(right.force[1] > 0.1);
      CHECK((rendered.force - right.force).norm() <
            (model == "quasi_static" ? 0.01 : 0.02) * right.force.norm());
    }
  }
}

TEST_CASE("friction feels what the tissue slips as it swings, also on supports that move") {
  // Pressed down and along in 0.1 s, in steps so short that the tissue is still on its way at the end of
  // each.
  for (const std::string_view model : models()) {
    Scene scene = block_scene({kBreath}, model, 0.001), still = block_scene({}, model, 0.001);
    scene.tools[0].shape.friction = still.tools[0].shape.friction = 0.3;
    Simulation organ(scene, block()), resting(still, block());
    double most = 0, off = 0;
    for (int i = 1; i <= 100; ++i) {
      const Vec3 p = kPressed + (1 - 0.01 * i) * Vec3(-0.001, 0.002, 0);
      const ToolForce rendered = organ.step(p + at(kBreath, 0.001 * i), 0.001),
                      right = resting.step(p, 0.001);
      most = std::max(most, right.force.norm());
      off = std::max(off, (rendered.force - right.force).norm());
    }
    CAPTURE(model);
    REQUIRE(most > 0.1);
    CHECK(off < 0.005 * most);  // what a quarter Hz bends of a block of 25 Hz, as above
  }
}

TEST_CASE("a surface that comes up 6 mm in one step takes the tool in front of it along") {
  const SupportMotion fast{Vec3::UnitY(), 0.03, 1.0};
  for (const std::string_view model : models()) {
    CAPTURE(model);
    Simulation resting(block_scene({}, model, 0.03), block()),
        moving(block_scene({fast}, model, 0.03), block());
    moving.step(kPressed, 0);
    resting.step(kPressed, 0);
    // Meanwhile the tool has gone back to where it touches 1.5 mm deep again: 5.6 mm up.
    const ToolForce rendered = moving.step(kPressed + at(fast, 0.03), 0.03),
                    right = resting.step(kPressed, 0.03);
    CHECK((rendered.force - right.force).norm() <
          (model == "quasi_static" ? 1e-6 : 0.05) * right.force.norm());
    // Twice as far, and the tool was as near to the bottom as to the top that went over it.
    const SupportMotion faster{Vec3::UnitY(), 0.075, 1.0};
    Simulation jumping(block_scene({faster}, model, 0.03), block());
    jumping.step(kPressed, 0);
    const ToolForce there = jumping.step(kPressed + at(faster, 0.03), 0.03);
    CHECK((there.force - right.force).norm() < (model == "quasi_static" ? 1e-6 : 0.12) * right.force.norm());
    // And a tool that stays is pushed, not passed.
    Simulation staying(block_scene({fast}, model, 0.02), block());
    staying.step(Vec3(0.001, 0.0049, 0.002), 0);
    CHECK(staying.step(Vec3(0.001, 0.0049, 0.002), 0.02).force[1] > 0.2);
  }
}

TEST_CASE("a tool that stays while the organ breathes under it feels no jolt: the force of statics") {
  const SupportMotion breath{Vec3(0.6, 0.8, 0), 0.001, 3};
  constexpr double kStep = 0.02;
  Simulation still(block_scene({breath}), block());
  std::vector<Vec3> expected;
  double most = 0;
  for (int i = 0; i < 300; ++i) {
    expected.push_back(still.step(kPressed, kStep).force);
    most = std::max(most, expected.back().norm());
  }
  for (const std::string_view model : models()) {
    Simulation moving(block_scene({breath}, model, kStep), block());
    for (int i = 0; i < 300; ++i) {
      const ToolForce rendered = moving.step(kPressed, kStep);
      CAPTURE(model, i, rendered.force.transpose(), expected[i].transpose());
      CHECK_FALSE(rendered.flagged);
      if (i >= 50) CHECK((rendered.force - expected[i]).norm() < 0.02 * most);  // after the tool came down
    }
  }
}

TEST_CASE(
    "a sample tells the organ's velocity, and laws that hear it hold the force on a tool that goes along") {
  Simulation organ(block_scene({kBreath}), block());
  ServedTools tools(organ);
  std::vector<SessionInput> inputs{{7, {.tick = 1}, true}};
  auto& state = inputs[0].state;
  using protocol::ToolState;
  state.flags = ToolState::kRequestsTangent | ToolState::kRequestsAhead;
  state.lead_ns = 50'000'000;
  const double t = 0.5;
  state.t_ns = from_seconds(t).count();
  state.p_W = kPressed + at(kBreath, t);
  state.v_W = speed_of(kBreath, t);
  const protocol::ForceSample sample = *tools.step(inputs, t)[0].answer;
  CHECK((sample.surface_v_W - speed_of(kBreath, t)).norm() < 1e-12);
  CHECK((sample.ahead_p_W - sample.p_W).norm() < 1e-12);  // on the organ, the tool stands still
  for (const char* name : {"tangent", "two_tangents"}) {
    const auto law = find_row(client::extrapolators(), name, "law", "test").make();
    law->update(client::sample_of(sample));
    for (const double age : {0.0, 0.01, 0.035, 0.1}) {
      const Vec3 p = sample.p_W + age * sample.surface_v_W;
      CHECK((law->force(p, from_seconds(t + age)) - sample.f_W).norm() < 1e-9 * sample.f_W.norm());
    }
  }
  state.flags = 0;
  CHECK(tools.step(inputs, 0.03)[0].answer->surface_v_W == Vec3::Zero());
}

TEST_CASE("a step of a moving organ does not allocate, but by implicit, and equal runs are equal") {
  for (const std::string_view model : models()) {
    Simulation one(block_scene({kBreath}, model, 0.03), block()),
        two(block_scene({kBreath}, model, 0.03), block());
    one.step(kPressed, 0.03);
    two.step(kPressed, 0.03);
    std::size_t allocations = 1;
    {
      const test::AllocationGuard guard;
      for (int i = 0; i < 10; ++i) one.step(kPressed, 0.03);
      allocations = guard.count();
    }
    CAPTURE(model);
    if (model != "implicit") CHECK(allocations == 0);
    for (int i = 0; i < 10; ++i) two.step(kPressed, 0.03);
    CHECK(one.state_hash() == two.state_hash());
  }
}

TEST_CASE("a motion that cannot be is refused in one line") {
  const test::TemporaryFolder folder;
  folder.write("organ.msh", "");
  const auto error = [&](const std::string& motion, const std::string& model) {
    const auto file = folder.write(
        "scene.toml", fmt::format("[mesh]\nfile = \"organ.msh\"\n[[fixed]]\nbox = [[0, 0, 0], [1, 1, "
                                  "1]]\n[[fixed.motion]]\n{}\n[deformation]\nmodel = "
                                  "\"{}\"\n[[tool]]\nradius = 0.005\n",
                                  motion, model));
    try {
      read_scene(file);
    } catch (const Error& e) {
      return std::string(e.what()).substr(file.string().size());
    }
    return std::string("none");
  };
  const std::string good = "direction = [0, 2, 0]\namplitude = 0.01\nperiod = 4";
  CHECK(error(good, "quasi_static") == "none");
  CHECK(
      error(good, "rigid")
          .starts_with(":3: [[fixed.motion]]: model \"rigid\" does not move with its supports; quasi_static, "
                       "tensor_mass, implicit"));
  CHECK(error("direction = [0, 0, 0]\namplitude = 0.01\nperiod = 4", "quasi_static") ==
        ":6: `direction` needs a length above 0");
  CHECK(error(good + "\nperoid = 3", "quasi_static").starts_with(":9: unknown key"));
}

TEST_CASE(
    "moving organ: of two tools that pressed and were lifted, one before the other, nothing stays behind") {
  for (const std::string_view model : models()) {
    CAPTURE(model);
    Scene scene = block_scene({kBreath}, model, 0.01);
    scene.tools.push_back(scene.tools[0]);
    Simulation two(scene, block()), none(scene, block());
    std::vector<ToolInput> inputs(2);
    const auto continue_ = [&](int steps) {
      for (int i = 0; i < steps; ++i) {
        two.step(inputs, 0.01);
        none.step(std::vector<ToolInput>(2), 0.01);
      }
    };
    inputs[0].pose = ToolPose(kPressed);
    inputs[1].pose = ToolPose(kPressed + Vec3(0.012, 0, 0));
    continue_(40);
    REQUIRE(two.tool(0).force().contacts > 0);
    inputs[1].pose.reset();  // its client has left
    continue_(10);
    inputs[0].pose = ToolPose(kPressed + Vec3(0, 0.03, 0));
    continue_(400);
    double off = 0;
    for (std::size_t v = 0; v < two.positions().size(); ++v)
      off = std::max(off, (two.positions()[v] - none.positions()[v]).norm());
    CHECK(off < 2e-5);  // where 1.5 mm were pressed
  }
}
