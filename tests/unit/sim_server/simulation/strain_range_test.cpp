// Strain under a tool, against what the law of the tissue is meant for.
#include "sim_server/simulation/strain_range.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;
using Catch::Matchers::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE("the meant strain of the linear law is where Green's strain differs from it by a tenth") {
  const double e = meant_strain(ElasticLaw::kLinear);
  const double green = ((1 + e) * (1 + e) - 1) / 2;
  CHECK_THAT(green / e, WithinRel(1.1, 1e-12));
}

TEST_CASE("the meant strain of St. Venant and Kirchhoff's law is where a rod under compression gives way") {
  // Its force is E s (s^2 - 1) / 2 at the stretch s: the extremum is found by search.
  double most = 0, at = 1;
  for (double s = 1; s > 0.1; s -= 1e-4) {
    if (s * (1 - s * s) > most) most = s * (1 - s * s), at = s;
  }
  CHECK_THAT(meant_strain(ElasticLaw::kStVenantKirchhoff), WithinAbs(1 - at, 0.005));
}

TEST_CASE("steps are counted beyond the meant strain, and a strain that is no number is beyond it") {
  StrainRange range(ElasticLaw::kLinear);
  CHECK_FALSE(range.add(0.2));
  CHECK(range.to_text().empty());
  CHECK(range.add(0.45));
  CHECK(range.add(std::nan("")));
  CHECK_THAT(range.to_text(), Contains("strain up to 45 %") && Contains("in 2 of 3 steps") &&
                                  Contains("beyond the 20 %") && Contains("neo_hookean"));
  CHECK(range.to_json()["beyond_steps"] == 2);
}

TEST_CASE("a shallow press is within the linear law, a press by more than the radius is not, and says so") {
  Scene scene =
      scene_of({.young_modulus = 1e4, .poisson_ratio = 0.45}, {Vec3(-1, -1, -1), Vec3(1, -0.0399, 1)}, 0.006);
  scene.deformation.model = "quasi_static";
  Simulation simulation(scene,
                        grid_block(lines(-0.03, 0.03, 12), lines(-0.04, 0, 8), lines(-0.03, 0.03, 12)));
  const auto press = [&](double depth) {
    std::vector<ToolInput> input(1);
    input.front().pose = ToolPose(Vec3(0.0011, 0.006 - depth, 0.0007));
    return simulation.step(input, 1.0 / 30).front();
  };
  const ToolAnswer shallow = press(0.0005);
  CHECK(shallow.contacts > 0);
  CHECK_FALSE(shallow.strained);
  // An edge of 5 mm beside a tip 8 mm deep must go some 8 mm down within a few edges.
  const ToolAnswer deep = press(0.008);
  CHECK(deep.strained);
  CHECK_FALSE(deep.flagged);
  CHECK(simulation.strain()->to_json()["beyond_steps"] == 1);
}

TEST_CASE("tissue held from the start, or by a button, is judged for strain as pressed tissue is") {
  const bool from_the_start = GENERATE(true, false);
  const Vec3 place(0.0011, 0.0055, 0.0007);  // that presses by 0.5 mm
  Scene scene =
      scene_of({.young_modulus = 1e4, .poisson_ratio = 0.45}, {Vec3(-1, -1, -1), Vec3(1, -0.0399, 1)}, 0.006);
  scene.tools.front().grasp_buttons = from_the_start ? 0 : 1;
  if (from_the_start) scene.tools.front().grasp_place = place;
  Simulation simulation(scene,
                        grid_block(lines(-0.03, 0.03, 12), lines(-0.04, 0, 8), lines(-0.03, 0.03, 12)));
  const auto pull = [&](double up) {
    std::vector<ToolInput> input(1);
    input.front().pose = ToolPose(place + Vec3(0, up, 0));
    input.front().buttons = 1;
    return simulation.step(input, 1.0 / 30).front();
  };
  CHECK_FALSE(pull(0).strained);
  CHECK_FALSE(pull(0.001).strained);
  // An edge of 5 mm beside vertices that go 8 mm up is as long as the square root of 5^2 + 8^2 where its
  // other end stays; it follows by at most half of that.
  const ToolAnswer held = pull(0.008);
  CHECK(held.contacts >= 3);
  CHECK(held.strained);
  CHECK_FALSE(held.flagged);
  double largest = 0;
  for (const Triangle& t : simulation.surface().triangles) {
    for (int i = 0; i < 3; ++i) {
      const auto a = static_cast<std::size_t>(t[i]), b = static_cast<std::size_t>(t[(i + 1) % 3]);
      largest = std::max(largest, std::abs((simulation.positions()[a] - simulation.positions()[b]).norm() /
                                               (simulation.rest()[a] - simulation.rest()[b]).norm() -
                                           1));
    }
  }
  CHECK_THAT(simulation.strain()->to_json()["largest"].get<double>(), WithinRel(largest, 1e-9));
}

TEST_CASE("a wall that does not deform has no strain") {
  Scene scene;
  scene.deformation.model = "rigid";
  scene.tools.resize(1);
  scene.tools.front().shape = {.radius = 0.006};
  const Simulation simulation(scene,
                              grid_block(lines(-0.03, 0.03, 2), lines(-0.04, 0, 2), lines(-0.03, 0.03, 2)));
  CHECK(simulation.strain() == nullptr);
}
