// Linear tissue that a tool turns inside out: the force is held and flagged, in every model of that law.
#include "sim_server/models/deformation_models.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;
using Catch::Matchers::Contains;

namespace {

constexpr double kNotch = 1.0 / 30;  // s

/// The tool so deep in the middle of a block (m).
ToolAnswer push_to(Simulation& simulation, double depth) {
  return step(simulation, Vec3(0.0011, 0.005 - depth, 0.0007), {}, kNotch);
}

}  // namespace

TEST_CASE("linear tissue that a tool turns inside out is flagged, and its force held") {
  for (const DeformationModelRow& row : models_without_cutting()) {
    if (!row.deforms()) continue;
    CAPTURE(row.name);
    Simulation simulation(deep_block_scene(row.name), deep_block());
    Vec3 settled = Vec3::Zero();
    for (int i = 0; i < 30; ++i) settled = push_to(simulation, 0.004).force;
    REQUIRE(simulation.flagged().to_text().empty());
    REQUIRE(settled.norm() > 0.01);
    // 4 mm a notch, to twice the depth of the block, so that the tip comes out behind.
    Vec3 force = settled;
    int flagged = 0;
    for (double depth = 0.008; depth < 0.06; depth += 0.004) {
      const ToolAnswer answer = push_to(simulation, depth);
      if (answer.flagged && answer.doubt == Doubt::kInsideOut) {
        ++flagged;
        CHECK(answer.force == force);
        CHECK(answer.tangent.isZero(0));
      }
      CHECK((answer.flagged || depth < 0.025));  // deeper than the block is
      force = answer.force;
    }
    CHECK(flagged > 5);
    CHECK_THAT(simulation.flagged().to_text(), Contains("inside out"));
  }
}

TEST_CASE("tissue that is strained by a tool as deep as its radius is not inside out") {
  for (const DeformationModelRow& row : models_without_cutting()) {
    if (!row.deforms()) continue;
    CAPTURE(row.name);
    Simulation simulation(deep_block_scene(row.name), deep_block());
    for (double depth = 0; depth < 0.005; depth += 2.5e-4) CHECK_FALSE(push_to(simulation, depth).flagged);
    CHECK(simulation.strain()->is_inside_out(0.2, -0.01));
    CHECK(simulation.strain()->is_inside_out(3.1, 1));
    CHECK_FALSE(simulation.strain()->is_inside_out(2.9, 0.01));
  }
}

TEST_CASE("tissue of a law that knows turns is judged by its elements alone") {
  CHECK_FALSE(StrainRange(ElasticLaw::kCorotational).is_inside_out(5, -1));
  CHECK_FALSE(StrainRange(ElasticLaw::kNeoHookean).is_inside_out(5, -1));
}
