#include "sim_server/commands/pictures.h"

#include "sim_server/mesh/shapes.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// A block of 60 x 40 x 60 mm, held at the bottom, y = 0.
Scene coarse_block_scene(const std::string& model, ElementKind element) {
  Material material{.young_modulus = 2e3, .poisson_ratio = 0.3};
  material.element = element;
  Scene scene = test::scene_of(material, Box{{-1, -1, -1}, {1, 1e-6, 1}}, 0.005);
  scene.deformation.model = model;
  scene.rate_hz = 30;
  return scene;
}
TetMesh coarse_block() {
  const std::vector<double> x{0, 0.02, 0.04, 0.06}, y{0, 0.02, 0.04};
  return grid_block(x, y, x);
}

}  // namespace

TEST_CASE("pictures: stretched evenly, all of a body has the energy density of that strain") {
  for (const ElementKind element : {ElementKind::kLinear, ElementKind::kQuadratic}) {
    const Scene scene = coarse_block_scene("implicit", element);
    const Simulation simulation(scene, coarse_block());
    REQUIRE(facts_of(scene, simulation).fields == std::vector<std::string>{"strain_energy"});
    std::vector<Vec3> nodes = simulation.mesh().vertices;
    constexpr double kStrain = 0.01;
    for (Vec3& x : nodes) x[1] *= 1 + kStrain;
    std::vector<float> values;
    strain_energy_of(scene, simulation)(nodes, values);
    REQUIRE(values.size() == simulation.surface().vertices.size());
    const double density =
        0.5 * (scene.material->lame_lambda() + 2 * scene.material->lame_mu()) * kStrain * kStrain;
    for (const float value : values) CHECK(static_cast<double>(value) == Approx(density).epsilon(1e-4));
  }
}

TEST_CASE("pictures: a model that knows its surface alone offers no field") {
  const Scene scene = coarse_block_scene("quasi_static", ElementKind::kLinear);
  const Simulation simulation(scene, coarse_block());
  CHECK(facts_of(scene, simulation).fields.empty());
}

TEST_CASE("pictures: what is held and what a tool reaches is told, and the loads are the tool's force") {
  Scene scene = coarse_block_scene("quasi_static", ElementKind::kLinear);
  scene.tools[0].reach = Box{{0, 0.03, 0}, {0.025, 0.05, 0.025}};
  Simulation simulation(scene, coarse_block());
  const SceneFacts facts = facts_of(scene, simulation);
  for (std::size_t v = 0; v < facts.organ.rest.size(); ++v) {
    CHECK(((facts.organ.flags[v] & OrganShape::kFixed) != 0) == (facts.organ.rest[v][1] < 1e-6));
    // Reach takes whole triangles: nothing of the far end.
    if (facts.organ.rest[v][0] > 0.05) CHECK((facts.organ.flags[v] & OrganShape::kInReach) == 0);
  }
  CHECK(std::ranges::any_of(facts.organ.flags, [](auto f) { return (f & OrganShape::kInReach) != 0; }));

  Picture picture;
  picture.positions.resize(3 * facts.organ.rest.size());
  const ToolForce force = simulation.step(Vec3(0.01, 0.0405, 0.01), 0.03);
  REQUIRE(force.contacts > 0);
  show_organ(simulation, picture);
  const SeenTool& tool = picture.tools[0];
  const Vec3 sum = sum_of(std::span(tool.loads).first(tool.load_count));
  CHECK((sum + force.force).norm() < 1e-5 * force.force.norm());
  for (std::size_t v = 0; v < facts.organ.rest.size(); ++v)
    CHECK(static_cast<double>(picture.positions[3 * v + 1]) ==
          Approx(simulation.positions()[v][1]).margin(1e-7));
}

TEST_CASE("pictures: of a tool that nobody holds any more no force is shown, nor the errors of whom it was") {
  SeenTool seen;
  ServedTools::Outcome outcome;
  outcome.force.force = Vec3(0, 1, 0);
  outcome.force.contacts = 2;
  outcome.answer.emplace();
  outcome.answer->number = 7;
  outcome.answer->flags = protocol::ForceSample::kHasErrors;
  outcome.answer->errors.mesh = {ErrorSource::kMeasured, 12};
  SessionInput input;
  input.session = 1;
  show_tool(input, &outcome, 1, seen);
  CHECK(seen.f_W == Vec3(0, 1, 0));
  CHECK(seen.contact);
  CHECK(seen.errors.mesh.percent == 12);
  show_tool(input, nullptr, 2, seen);  // no step meanwhile: it feels what it felt
  CHECK(seen.f_W == Vec3(0, 1, 0));
  input.session = 0;
  show_tool(input, nullptr, 3, seen);
  CHECK(seen.f_W.isZero(0));
  CHECK_FALSE(seen.contact);
  CHECK_FALSE(seen.errors.mesh.known());
}

TEST_CASE("pictures: how far from the plan something was cut is told where there is a plan, and a cut") {
  Scene scene = coarse_block_scene("tensor_mass", ElementKind::kLinear);
  scene.tools[0].cut_buttons = 1;
  for (const bool planned : {false, true}) {
    scene.cutting = Cutting{.where = "test"};
    if (planned) scene.cutting->plan = CutPlan{.point = Vec3(0.03, 0, 0), .normal = Vec3(1, 0, 0)};
    const Simulation simulation(scene, coarse_block());
    Picture picture;
    picture.positions.resize(3 * simulation.positions().size());
    show_organ(simulation, picture);
    REQUIRE(picture.resection.has_value());
    CHECK(std::isnan(picture.resection->mean_distance));
    CHECK(std::isnan(picture.resection->furthest));
    CHECK(std::isnan(picture.resection->mean_separated_distance));
  }
}
