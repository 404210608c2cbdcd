// Thin sheets that a quick tool presses stay on the side of it where they were.
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kDt = 1.0 / 30, kRadius = 0.006, kDepth = 0.015, kClear = 0.01;

/// 60 x 60 mm, held at two edges, top at y = 0.
Simulation sheet(const std::string& model, ElasticLaw law, double thickness) {
  Scene scene =
      scene_of({.young_modulus = 1e4, .law = law}, {Vec3(-1, -1, -1), Vec3(-0.0299, 1, 1)}, kRadius);
  scene.fixed.push_back({Region{.box = Box{Vec3(0.0299, -1, -1), Vec3(1, 1, 1)}, .where = "test"}});
  scene.deformation.model = model;
  return {scene, grid_block(lines(-0.03, 0.03, 14), lines(-thickness, 0, 2), lines(-0.03, 0.03, 14))};
}

/// The force (N, upwards) at the end of a press to `kDepth` at `speed` (m/s) that begins at `begin` (s), held
/// for 2 s; the steps that were flagged while it was held.
std::pair<double, int> pressed(Simulation simulation, double speed, double begin, double depth = kDepth) {
  const double arrives = begin + (depth + kClear) / speed;
  ToolForce published;
  int flagged = 0;
  for (double t = 0; t < arrives + 2; t += kDt) {
    const double way = std::clamp((t - begin) * speed, 0.0, depth + kClear);
    published = simulation.step(ToolPose(Vec3(0.0011, kRadius + kClear - way, 0.0007)), kDt);
    if (t > arrives + 1) flagged += published.flagged ? 1 : 0;
  }
  return {published.force.y(), flagged};
}

}  // namespace

TEST_CASE("thin sheets: quick presses end at the force of a slow one, whatever the phase of the steps") {
  struct Case {
    std::string model;
    ElasticLaw law;
  };
  for (const auto& [model, law] :
       {Case{"implicit", ElasticLaw::kCorotational}, Case{"implicit", ElasticLaw::kNeoHookean},
        Case{"reduced", ElasticLaw::kLinear}}) {
    for (const double thickness : {0.001, 0.006}) {
      // Of a linear tissue, the equilibrium itself.
      const std::string calm = law == ElasticLaw::kLinear ? "quasi_static" : model;
      const double right = pressed(sheet(calm, law, thickness), 0.03, 0.1).first;
      REQUIRE(right > 0.003);
      for (const double speed : {0.23, 0.35, 0.6}) {
        for (const double phase : {0.0, 0.5}) {
          const auto [force, flagged] = pressed(sheet(model, law, thickness), speed, 0.1 + phase * kDt);
          CAPTURE(model, static_cast<int>(law), thickness, speed, phase);
          CHECK(force == Approx(right).epsilon(0.02));
          CHECK(flagged == 0);
        }
      }
    }
  }
}

TEST_CASE("thin sheets: one that bends by five tool radii is still felt, in every model") {
  for (const std::string model : {"quasi_static", "tensor_mass", "implicit"}) {
    // A membrane under a ball that is small against it stiffens or stays as stiff: of the linear law, as the
    // contact grows.
    const double half = pressed(sheet(model, ElasticLaw::kLinear, 0.003), 0.1, 0.1, 0.014).first;
    const auto [entire, flagged] = pressed(sheet(model, ElasticLaw::kLinear, 0.003), 0.1, 0.1, 0.028);
    CAPTURE(model, half);
    CHECK(entire > 1.8 * half);
    CHECK(flagged == 0);
  }
}
