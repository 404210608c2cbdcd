// A simulation that is saved and restored continues byte for byte, whatever its model, also while it is cut.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/hash.h"
#include "sim_server/models/spring.h"
#include "tests/support/catch.h"
#include "tests/support/contract.h"
#include "tests/support/model_cases.h"
#include "tests/support/soft_block.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kStep = 1.0 / 30;  // s
constexpr std::uint16_t kHot = 1;

/// A model case, and whether the tissue is cut.
struct SavedCase {
  ModelCase choice;
  enum class Cut { kNone, kHeat, kBlade } cut = Cut::kNone;

  std::string name() const {
    constexpr std::array kCuts{"", ", cut by heat", ", cut by a blade"};
    return choice.name() + kCuts[static_cast<std::size_t>(cut)];
  }
  Scene scene() const {
    Scene scene = deep_block_scene(choice.row.name, 0.003);
    choice.choose(scene);
    scene.deformation.of<ImplicitSettings>().tolerance = 1e-6;
    scene.deformation.of<ImplicitSettings>().max_newton = 8;
    scene.deformation.of<ImplicitSettings>().refresh_steps = 3;
    if (scene.deformation.model == "spring")
      scene.deformation.of<SpringSettings>().stiffness = Vec3(300, 200, 400);
    if (scene.deformation.model == "spring") scene.deformation.of<SpringSettings>().hardening_length = 0.01;
    if (!choice.row.needs_cutting) scene.cutting.reset();
    if (!choice.row.needs_cutting && cut == Cut::kNone) return scene;
    scene.tools[0].cut_buttons = kHot;
    scene.cutting = Cutting{.power = 40, .energy = 2e8, .where = "test"};
    scene.cutting->region = Region{.box = Box{Vec3(-1, -0.011, -0.011), Vec3(1, 1, 0.011)}, .where = "test"};
    if (cut == Cut::kBlade) scene.tools[0].blade = Vec3(0, -0.008, 0);
    return scene;
  }
  TetMesh mesh() const { return with_nodes(deep_block(), choice.element); }
};

std::vector<SavedCase> saved_cases() {
  std::vector<SavedCase> cases;
  for (const ModelCase& choice : model_cases()) {
    cases.push_back({choice});
    const bool cuts = choice.row.cuts && choice.element == ElementKind::kLinear && !choice.fibres &&
                      !choice.relaxes && !choice.second_order;
    if (!cuts) continue;
    cases.push_back({choice, SavedCase::Cut::kHeat});
    cases.push_back({choice, SavedCase::Cut::kBlade});
  }
  return cases;
}

/// Step `i` of a tool that comes down, slides and lifts; it cuts from step 6 on.
ToolAnswer press(Simulation& simulation, int i) {
  const Vec3 p(-0.01 + 4e-4 * i, 0.0035 - 0.0004 * std::min(i, 10) + (i % 17 > 14 ? 0.01 : 0.0), 0.0005);
  return step(simulation, p,
              {.buttons = static_cast<std::uint16_t>(i >= 6 ? kHot : 0),
               .request = {.at_tool = true, .surface_shift = true}},
              kStep);
}

std::vector<std::uint64_t> hashes(Simulation& simulation, int from, int to) {
  std::vector<std::uint64_t> all;
  for (int i = from; i < to; ++i) {
    Fnv1a hash;
    const ToolAnswer answer = press(simulation, i);
    hash.add(answer.force);
    if (answer.at_tool) hash.add(answer.at_tool->tangent.data(), sizeof(Mat3));
    if (answer.surface_shift_W) hash.add(*answer.surface_shift_W);
    if (answer.modes != nullptr)
      hash.add(answer.modes->q.data(), static_cast<std::size_t>(answer.modes->q.size()) * sizeof(double));
    all.push_back(hash.value());
    all.push_back(simulation.state_hash());
  }
  return all;
}

}  // namespace

CONTRACT("a saved state continues byte for byte", SavedCase, choice, saved_cases()) {
  constexpr int kSaved = 22, kEnd = 40;
  Simulation simulation(choice.scene(), choice.mesh());
  const SimulationState start = simulation.save();
  const std::vector<std::uint64_t> before = hashes(simulation, 0, kSaved);
  const SimulationState saved = simulation.save();
  const std::vector<std::uint64_t> after = hashes(simulation, kSaved, kEnd);
  if (choice.cut == SavedCase::Cut::kHeat) CHECK(simulation.resection()->totals().tetrahedra > 0);
  if (choice.cut == SavedCase::Cut::kBlade) CHECK(simulation.resection()->totals().splits > 0);
  const SimulationState copy = saved;
  simulation.restore(copy);
  CHECK(hashes(simulation, kSaved, kEnd) == after);
  simulation.restore(start);
  CHECK(hashes(simulation, 0, kSaved) == before);
  CHECK(hashes(simulation, kSaved, kEnd) == after);
  simulation.restore(saved);  // once more, after the start
  CHECK(hashes(simulation, kSaved, kEnd) == after);
}

TEST_CASE("two tools, with friction and a grasp: a saved state continues byte for byte") {
  for (const char* const model : {"quasi_static", "tensor_mass", "reduced", "implicit"}) {
    CAPTURE(model);
    Scene scene = wide_block_scene(2, 0.005, model);
    for (ToolSettings& tool : scene.tools) tool.shape.friction = 0.3;
    scene.tools[1].grasp_buttons = 2;
    Simulation simulation(scene, wide_block());
    const auto run = [&](int from, int to) {
      std::vector<std::uint64_t> all;
      for (int i = from; i < to; ++i) {
        const double down = 0.006 - 3e-4 * std::min(i, 20);
        std::vector<ToolInput> inputs(2);
        inputs[0] = {.pose = ToolPose(Vec3(-0.012 + 1e-4 * i, down, 0.0003)), .request = {.at_tool = true}};
        inputs[1] = {.pose = ToolPose(Vec3(0.012, down + (i > 25 ? 0.002 : 0), -0.0004)),
                     .buttons = static_cast<std::uint16_t>(i > 18 ? 2 : 0),
                     .request = {.at_tool = true}};
        Fnv1a hash;
        for (const ToolAnswer& answer : simulation.step(inputs, kStep)) hash.add(answer.force);
        all.push_back(hash.value());
        all.push_back(simulation.state_hash());
      }
      return all;
    };
    run(0, 24);
    const SimulationState saved = simulation.save();
    const std::vector<std::uint64_t> after = run(24, 40);
    simulation.restore(saved);
    CHECK(run(24, 40) == after);
  }
}
