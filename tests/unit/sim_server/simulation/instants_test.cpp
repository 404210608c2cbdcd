// Contact at several instants of a step, along the path that the tool took.
#include <cmath>

#include "sim_server/models/deformation_models.h"
#include "sim_server/models/reduced.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/contact_instants.h"
#include "tests/support/catch.h"
#include "tests/support/served_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr int kInstants = 10;
constexpr double kStep = 0.02;  // s

Scene moving_block(std::string_view model, double rate_hz, int instants) {
  Scene scene = block_scene();
  scene.material->density = 1000;
  scene.rate_hz = rate_hz;
  scene.deformation.model = model;
  scene.deformation.of<ReducedSettings>().modes = 20;
  scene.deformation.of<ContactInstants>().instants = instants;
  return scene;
}

/// Presses 3 mm deep in 0.1 s, and slides.
Vec3 place(double t) {
  const double fraction = std::min(t / 0.1, 1.0);
  return {0.001 + 0.01 * t, 0.006 - 0.004 * fraction * fraction, 0.0005};
}

}  // namespace

TEST_CASE("instants: a step with contact at ten of them is ten steps") {
  for (const DeformationModelRow& row : models_without_cutting()) {
    if (!row.moves || !row.deforms()) continue;
    const std::string_view model = row.name;
    CAPTURE(model);
    Simulation entire(moving_block(model, 1 / kStep, kInstants), block_mesh()),
        cut(moving_block(model, kInstants / kStep, 1), block_mesh());
    REQUIRE(entire.instants() == kInstants);
    std::vector<ToolInput> input(1);
    for (int step = 1; step <= 10; ++step) {
      Vec3 sum = Vec3::Zero(), last;
      std::vector<PathPoint> path;
      for (int k = 1; k <= kInstants; ++k) {
        const Vec3 p = place(kStep * (step - 1 + static_cast<double>(k) / kInstants));
        last = cut.step(p, kStep / kInstants).force;
        sum += last;
        if (k < kInstants) path.push_back({p});
      }
      input[0].pose = place(kStep * step);
      input[0].path = path;
      const ToolAnswer answer = entire.step(input, kStep).front();
      CHECK((answer.force - last).norm() <= 1e-9 * last.norm());
      CHECK((answer.mean_force - sum / kInstants).norm() <= 1e-9 * sum.norm());
    }
    CHECK(cut.tool(0).force().force.norm() > 0.1);
  }
}

TEST_CASE("instants: without a path the tool goes evenly and straight from where it was told last") {
  Simulation published(moving_block("tensor_mass", 1 / kStep, 4), block_mesh()),
      silent(moving_block("tensor_mass", 1 / kStep, 4), block_mesh());
  std::vector<ToolInput> input(1);
  Vec3 from = place(0);
  for (int step = 0; step <= 8; ++step) {
    const Vec3 to = place(kStep * step);
    std::vector<PathPoint> path;
    for (int k = 1; k < 4; ++k) path.push_back({Vec3(from + 0.25 * k * (to - from))});
    input[0] = {.pose = to, .path = path};
    const Vec3 right = published.step(input, kStep).front().force;
    input[0].path = {};
    CHECK((silent.step(input, kStep).front().force - right).norm() <= 1e-9 * right.norm());
    from = to;
  }
}

TEST_CASE("instants: only tissue in motion has more than one, and a scene that was not read has one") {
  Scene scene = moving_block("tensor_mass", 33.3, 1);
  scene.deformation.of<ContactInstants>().instants = {};
  scene.material->young_modulus = 2e3;
  CHECK(Simulation(scene, block_mesh()).instants() > 4);
  scene.deformation.model = "quasi_static";
  CHECK(Simulation(scene, block_mesh()).instants() == 1);
  Scene bare = block_scene();
  bare.material->density = 1000;
  bare.rate_hz = 33.3;
  bare.deformation.model = "tensor_mass";
  CHECK(Simulation(bare, block_mesh()).instants() == 1);
}
