// The scenes that ship with tools that have an axis.
#include "sim_server/explain.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace palpate;
using namespace palpate::sim;

TEST_CASE("a finger on the liver, and an instrument: pressed from above they feel it; explain tells of it") {
  for (const char* name : {"liver_capsule", "liver_trocar"}) {
    CAPTURE(name);
    const Scene scene = read_scene(fmt::format("{}/configs/scenes/{}.toml", PALPATE_SOURCE_DIR, name));
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
}
