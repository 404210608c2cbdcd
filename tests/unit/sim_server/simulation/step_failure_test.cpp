// A step that finds no memory ends neither the program nor the session.
#include "sim_server/simulation/simulation.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kDt = 1.0 / 30, kRadius = 0.004;
const ToolPose kPressed(Vec3(0.001, kRadius - 0.002, 0.002));

const std::vector<ToolInput> kTwo{{.pose = kPressed},
                                  {.pose = ToolPose(Vec3(-0.009, kRadius - 0.002, 0.002))}};

/// A block of corotational tissue, pressed by 2 mm, by one tool or by two, until it rests.
[[maybe_unused]] Simulation pressed_block(bool by_two = false) {
  Scene scene = scene_of({.young_modulus = 1e4, .poisson_ratio = 0.45, .law = ElasticLaw::kCorotational},
                         {Vec3(-1, -1, -1), Vec3(1, -0.0149, 1)}, kRadius);
  scene.deformation.model = "implicit";
  if (by_two) scene.tools.push_back(scene.tools.front());
  Simulation simulation(scene,
                        grid_block(lines(-0.015, 0.015, 4), lines(-0.015, 0, 2), lines(-0.015, 0.015, 4)));
  for (int i = 0; i < 20; ++i)
    by_two ? void(simulation.step(kTwo, kDt)) : void(simulation.step(kPressed, kDt));
  return simulation;
}

}  // namespace

#if !defined(PALPATE_SANITIZED)
TEST_CASE("a step that runs out of memory holds the last answer, flagged and counted") {
  const Vec3 rests = pressed_block().step(kPressed, kDt).force;
  REQUIRE(rests.norm() > 0.05);
  std::uint64_t failed = 0;
  bool last = false;
  for (std::size_t n = 1; !last; n = n + 1 + n / 4) {
    CAPTURE(n);
    Simulation simulation = pressed_block();
    ToolForce published;
    {
      const AllocationFailure failure(n);
      published = simulation.step(kPressed, kDt);
      last = !failure.happened();
    }
    if (last) break;
    // What a library makes of it by itself may settle in the end.
    const bool threw = simulation.failures().out_of_memory + simulation.failures().other == 1;
    failed += threw ? 1 : 0;
    CHECK((published.force - rests).norm() < 0.01 * rests.norm());
    if (threw) CHECK(published.flagged);
    if (threw) CHECK(published.tangent.isZero());
    for (int i = 0; i < 20; ++i) published = simulation.step(kPressed, kDt);
    CHECK_FALSE(published.flagged);
    CHECK((published.force - rests).norm() < 0.01 * rests.norm());
  }
  CHECK(failed > 5);
}

TEST_CASE("the force of a tissue that answers no more fades, and a lifted tool feels none of it") {
  Simulation simulation = pressed_block();
  double before = simulation.step(kPressed, kDt).force.norm();
  for (int i = 0; i < 5; ++i) {
    const AllocationFailure failure(1);
    const ToolForce published = simulation.step(kPressed, kDt);
    CHECK(published.flagged);
    CHECK(published.force.norm() == Approx(i == 0 ? before : before / 2).epsilon(1e-3));
    before = published.force.norm();
  }
  CHECK(simulation.failures().out_of_memory == 5);
  CHECK(simulation.flagged().threw == 5);
  CHECK(simulation.flagged().to_text() == "5 failed");
  const std::vector<ToolInput> away(1);
  const AllocationFailure failure(1);
  CHECK(simulation.step(away, kDt).front().force.isZero());
}

TEST_CASE(
    "a tool whose client leaves when memory has ended is lifted all the same, and the tissue goes free") {
  Simulation simulation = pressed_block(true);
  std::vector<ToolInput> remaining = kTwo;
  remaining[0] = {.enters = true};
  {
    const AllocationFailure failure(1);
    CHECK(simulation.step(remaining, kDt)[0].force.isZero());
    CHECK(failure.happened());
  }
  const auto answers = simulation.step(remaining, kDt);
  CHECK(answers[0].force.isZero());
  CHECK(answers[1].force.norm() > 0.05);
  const std::vector<ToolInput> away(2);
  for (int i = 0; i < 60; ++i) CHECK(simulation.step(away, kDt).front().force.isZero());
  double off = 0;
  for (std::size_t v = 0; v < simulation.positions().size(); ++v)
    off = std::max(off, (simulation.positions()[v] - simulation.rest()[v]).norm());
  CHECK(off < 1e-4);
}
#endif
