// Scenes that ship.
#include <fmt/core.h>

#include "sim_server/commands/explain.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene_file/read_scene.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/scenes.h"

using namespace palpate;
using namespace palpate::sim;

TEST_CASE("a finger on the liver, and an instrument: pressed from above they feel it, explain tells of it") {
  for (const char* name : {"liver_capsule", "liver_trocar"}) {
    CAPTURE(name);
    const Scene scene = read_scene(fmt::format("{}/configs/scenes/{}.toml", test::source_dir(), name));
    Simulation simulation(scene);
    const Vec3 above(-0.03, 0.1, 0.005);
    CHECK(simulation.step(above, 1 / scene.rate_hz).contacts == 0);
    ToolForce force;
    for (double down = 0; down <= 0.036; down += 0.002)
      force = simulation.step(above - down * Vec3::UnitY(), 1 / scene.rate_hz);
    CHECK(force.contacts > 0);
    CHECK_FALSE(force.flagged);
    CHECK(force.force[1] > 0.05);
    CHECK(force.force.norm() < 5);
    const Explanation explanation = explain(scene);
    CHECK(explanation.steps.contacts == 200);
    CHECK_FALSE(to_text(explanation).empty());
  }
}

TEST_CASE("a tip that rubs on the liver is held back sideways, by no more than friction allows") {
  const Scene scene = test::example_scene("liver_friction");
  Simulation simulation(scene);
  const double dt = 1 / scene.rate_hz;
  Vec3 place(-0.03, 0.1, 0.005);
  ToolForce force;
  while (place.y() > 0.02 && force.force.y() < 0.5)
    force = simulation.step(place -= 0.001 * Vec3::UnitY(), dt);
  CHECK(force.force.y() >= 0.5);
  const double before = force.force.x();
  for (int i = 0; i < 10; ++i) force = simulation.step(place += 0.001 * Vec3::UnitX(), dt);
  CHECK_FALSE(force.flagged);
  CHECK(force.force.x() < before - 0.1 * force.force.y());
  // Of 0.3, on a surface that may lean by some degrees.
  CHECK(std::abs(force.force.x() - before) < 0.45 * force.force.y());
}

TEST_CASE("the liver is harder to press above its lump, by every model, and beside it as without") {
  Scene lump = test::example_scene("liver_lump"), plain = lump;
  plain.inclusions.clear();
  const double dt = 1 / lump.rate_hz;
  const auto pressed = [&](const Scene& scene, const Vec3& top) {
    Simulation simulation(scene);
    for (int i = 0; i < 20; ++i) simulation.step(top + (0.007 - 0.0002 * i) * Vec3::UnitY(), dt);
    for (int i = 0; i < 20; ++i) simulation.step(top + 0.003 * Vec3::UnitY(), dt);
    return simulation.tool(0).force().force.norm();
  };
  const Vec3 above(-0.03, 0.073, 0.005), beside(0.05, 0.06, 0.005);
  for (const DeformationModelRow& row : models_without_cutting()) {
    if (!row.deforms()) continue;
    CAPTURE(row.name);
    lump.deformation.model = plain.deformation.model = row.name;
    lump.material->law = plain.material->law =
        row.materials == Materials::kAny ? ElasticLaw::kCorotational : ElasticLaw::kLinear;
    CHECK(pressed(lump, above) > 1.1 * pressed(plain, above));
    CHECK(pressed(lump, beside) == Approx(pressed(plain, beside)).epsilon(0.02));
  }
}
