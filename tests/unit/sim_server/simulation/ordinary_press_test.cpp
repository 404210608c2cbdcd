// Presses that a hand makes, into soft tissue and by more than the tool's radius, are solved in every step.
#include <nlohmann/json.hpp>

#include "sim_server/models/implicit.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kDt = 1.0 / 30, kRadius = 0.006, kDepth = 0.01, kClear = 0.01;

struct Press {
  double force = 0;                // N, upwards, at the end
  int flagged = 0, most_work = 0;  // steps; contact linearisations of one step
};

/// 60 x 40 x 60 mm of 10 kPa, edges of 5 mm, pressed to `kDepth` at `speed` (m/s) from `begin` (s) on, then
/// held for 0.5 s.
Press press_block(ElasticLaw law, double speed, double begin) {
  Scene scene = scene_of({.young_modulus = 1e4, .poisson_ratio = 0.45, .law = law},
                         {Vec3(-1, -1, -1), Vec3(1, -0.0399, 1)}, kRadius);
  scene.deformation.model = "implicit";
  Simulation simulation(scene,
                        grid_block(lines(-0.03, 0.03, 12), lines(-0.04, 0, 8), lines(-0.03, 0.03, 12)));
  Press press;
  for (double t = 0; t < begin + (kDepth + kClear) / speed + 0.5; t += kDt) {
    const double removed = std::clamp((t - begin) * speed, 0.0, kDepth + kClear);
    const ToolForce published =
        simulation.step(ToolPose(Vec3(0.0011, kRadius + kClear - removed, 0.0007)), kDt);
    press.force = published.force.y();
    press.flagged += published.flagged ? 1 : 0;
    press.most_work = std::max(press.most_work, published.iterations);
  }
  return press;
}

}  // namespace

TEST_CASE(
    "a law that softens in compression turns elements inside out: that is told, with the law that does not") {
  for (const ElasticLaw law : {ElasticLaw::kStVenantKirchhoff, ElasticLaw::kNeoHookean}) {
    Scene scene = scene_of({.young_modulus = 1e4, .poisson_ratio = 0.45, .law = law},
                           {Vec3(-1, -1, -1), Vec3(1, -0.0399, 1)}, kRadius);
    scene.deformation.model = "implicit";
    Simulation simulation(scene,
                          grid_block(lines(-0.03, 0.03, 6), lines(-0.04, 0, 4), lines(-0.03, 0.03, 6)));
    for (int i = 0; i < 40; ++i)
      simulation.step(ToolPose(Vec3(0.0011, kRadius + 0.002 - std::min(0.02, i * 0.001), 0.0007)), kDt);
    const FlaggedSteps& flagged = simulation.flagged();
    CAPTURE(static_cast<int>(law), flagged.to_text());
    const bool softens = law == ElasticLaw::kStVenantKirchhoff;
    CHECK((flagged.inside_out > 0) == softens);
    CHECK((flagged.to_text().find("neo_hookean") != std::string::npos) == softens);
    CHECK(flagged.to_json()["inside_out"].get<std::uint64_t>() == flagged.inside_out);
  }
}

TEST_CASE("ordinary presses: every step is solved, with the force of a slow press at the end") {
  for (const ElasticLaw law : {ElasticLaw::kCorotational, ElasticLaw::kNeoHookean}) {
    const double right = press_block(law, 0.02, 0.1).force;
    REQUIRE(right > 0.5);
    for (const double speed : {0.05, 0.1, 0.15}) {
      for (const double phase : {0.0, 0.5}) {
        const Press press = press_block(law, speed, 0.1 + phase * kDt);
        CAPTURE(static_cast<int>(law), speed, phase, press.most_work);
        CHECK(press.flagged == 0);
        CHECK(press.force == Approx(right).epsilon(0.005));
        CHECK(press.most_work < 400);
      }
    }
  }
}
