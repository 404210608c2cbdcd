#include "sim_server/explicit/mass_scaling.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "sim_server/explicit/explicit_motion.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/contact_instants.h"
#include "tests/support/catch.h"
#include "tests/support/shaken_block.h"
#include "tests/support/soft_block.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

const Material kSoft{1e4, 0.4, 1060};

/// Of a tetrahedron alone and free, by the power method, rad/s.
double frequency_alone(const TetMesh& mesh, std::size_t tetrahedron, double mass_factor) {
  TetMesh alone;
  for (const int v : mesh.tetrahedra[tetrahedron])
    alone.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  alone.tetrahedra = {{0, 1, 2, 3}};
  return highest_frequency(ElasticTensors(alone, kSoft, {}, {mass_factor}));
}

double mass_of(const TetMesh& mesh, std::size_t tetrahedron) {
  return kSoft.density * six_volumes(mesh, mesh.tetrahedra[tetrahedron]) / 6;
}

Scene cuttable_scene(double fraction) {
  Scene scene = soft_block_scene(0.02, "tensor_mass", ElasticLaw::kLinear, 0.003);
  scene.tools[0].cut_buttons = 1;
  scene.cutting = Cutting{.power = 2, .energy = 1e7, .where = "test"};
  scene.deformation.of<AddedMass>().fraction = fraction;
  return scene;
}

/// What the model says of its tensors.
std::string published_of_tensors(const Simulation& simulation) {
  for (const MemoryPart& part : simulation.memory()) {
    if (part.name == "tensors") return part.detail;
  }
  return {};
}

int sub_steps_of(const Simulation& simulation) {
  const std::string published = published_of_tensors(simulation);
  const std::size_t end = published.find(" sub-steps");
  REQUIRE(end != std::string::npos);
  return std::stoi(published.substr(published.rfind(' ', end - 1)));
}

}  // namespace

TEST_CASE("scale_masses: no element alone is above its frequency, nor is the body, and no more is added") {
  const TetMesh mesh = shaken_block({4, 3, 4});
  double entire = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) entire += mass_of(mesh, e);
  double before = 0;
  for (const double fraction : {0.0, 0.01, 0.05, 0.2}) {
    CAPTURE(fraction);
    const MassScaling scaling = scale_masses(mesh, kSoft, fraction);
    double highest = 0, added = 0;
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
      CHECK(scaling.factors[e] >= 1);
      const double alone = frequency_alone(mesh, e, scaling.factors[e]);
      CHECK(alone <= scaling.frequency * (1 + 1e-6));
      // More than it needs none gets.
      if (scaling.factors[e] > 1) CHECK(alone == Approx(scaling.frequency).epsilon(1e-3));
      highest = std::max(highest, alone);
      added += (scaling.factors[e] - 1) * mass_of(mesh, e);
    }
    CHECK(highest == Approx(scaling.frequency).epsilon(1e-3));
    CHECK(scaling.added == Approx(added).margin(1e-12));
    CHECK(added <= fraction * entire * (1 + 1e-9));
    CHECK(highest_frequency(ElasticTensors(mesh, kSoft, {0, 1, 2}, scaling.factors)) <= scaling.frequency);
    if (before > 0) CHECK(scaling.frequency < before);
    before = scaling.frequency;
  }
}

TEST_CASE(
    "added_mass: the more a body may get, the fewer sub-steps it takes, and at rest it bears a tool alike") {
  const TetMesh mesh = shaken_block({12, 4, 8});
  std::vector<int> sub_steps;
  std::vector<Vec3> rendered;
  for (const double fraction : {0.0, 0.05, 0.2}) {
    Scene scene = cuttable_scene(fraction);
    sub_steps.push_back(sub_steps_of(Simulation(scene, mesh)));
    scene.deformation.of<ContactInstants>().instants = 200;
    Simulation simulation(scene, mesh);
    Vec3 force;
    for (int i = 0; i < 300; ++i) force = step(simulation, Vec3(0.001, -0.001, 0), {}, 1.0 / 30).force;
    rendered.push_back(force);
  }
  CHECK(sub_steps[1] < sub_steps[0]);
  CHECK(sub_steps[2] < sub_steps[1]);
  REQUIRE(rendered[0].norm() > 0.05);
  for (const Vec3& force : rendered) CHECK((force - rendered[0]).norm() < 1e-4 * rendered[0].norm());
}
