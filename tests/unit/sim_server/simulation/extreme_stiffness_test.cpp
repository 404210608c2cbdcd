// Tissue as stiff as metal, and what holds it: forces that follow the material, and walls that are one wall.
#include "sim_server/models/deformation_models.h"
#include "sim_server/models/spring.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kDt = 1.0 / 30, kRadius = 0.006;

/// 60 x 40 x 60 mm, bottom at y = -0.04 held.
Simulation organ(const std::string& model, double young_modulus) {
  Scene scene = scene_of({.young_modulus = young_modulus}, {Vec3(-1, -1, -1), Vec3(1, -0.0399, 1)}, kRadius);
  scene.deformation.model = model;
  scene.deformation.of<SpringSettings>().stiffness = Vec3::Constant(300);
  return {scene, grid_block(lines(-0.03, 0.03, 6), lines(-0.04, 0, 4), lines(-0.03, 0.03, 6))};
}

/// After steps enough to come to rest, N.
Vec3 force_at(Simulation& simulation, const Vec3& p) {
  ToolForce published;
  for (int i = 0; i < 20; ++i) published = simulation.step(ToolPose(p), kDt);
  CHECK_FALSE(published.flagged);
  return published.force;
}

}  // namespace

TEST_CASE("the force on linear tissue is in proportion to its modulus, from a pascal to a terapascal") {
  // Equilibrium K u = f: with all of K scaled and the motion the same, so are the forces.
  for (const char* model : {"quasi_static", "implicit"}) {
    const auto over_modulus = [&](double modulus) {
      Simulation simulation = organ(model, modulus);
      return Vec3(force_at(simulation, Vec3(0.002, kRadius - 0.002, 0.001)) / modulus);
    };
    const Vec3 right = over_modulus(1e4);
    REQUIRE(right.y() > 1e-7);
    for (const double modulus : {1.0, 1e2, 1e6, 1e9, 1e10, 1e11, 1e12}) {
      if (std::string(model) == "implicit" && modulus < 1e4) continue;  // it creeps to rest for seconds
      CAPTURE(model, modulus);
      CHECK((over_modulus(modulus) - right).norm() < 1e-3 * right.norm());
    }
  }
}

TEST_CASE("a held face is the same wall in every model that deforms or moves") {
  for (const DeformationModelRow& row : models_without_cutting()) {
    if (!row.deforms() && !row.moves) continue;  // of one stiffness everywhere
    for (const double depth : {0.0002, 0.001, 0.002}) {
      // Three vertices share what presses between them, so that the wall is one to three times as stiff as a
      // vertex: 2000 N/m; more where the tool's ball lies on more of them.
      Simulation simulation = organ(std::string(row.name), 1e4);
      const double force = -force_at(simulation, Vec3(0.002, -0.04 - kRadius + depth, 0.001)).y();
      CAPTURE(row.name, depth, force);
      CHECK(force > 0.99 * 2000 * depth);
      CHECK(force < 1.01 * 6000 * depth);
      Simulation same = organ("quasi_static", 1e4);
      CHECK(force == Approx(-force_at(same, Vec3(0.002, -0.04 - kRadius + depth, 0.001)).y()).epsilon(1e-3));
    }
  }
}
