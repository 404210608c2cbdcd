// A piece that a cut has made loose, and a tool pushes: it flies and turns as a body, in each linear model.
#include <Eigen/Geometry>
#include <algorithm>

#include "sim_server/elasticity/rotations.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kShortStep = 5e-3;  // s

/// A block held at its left side, all of which can be cut.
Scene loose_scene(std::string_view model) {
  Scene scene = soft_block_scene(0.02, model, ElasticLaw::kLinear, 0.004);
  scene.fixed[0].box = {Vec3(-1, -1, -1), Vec3(-0.0199, 1, 1)};
  scene.rate_hz = 1 / kShortStep;
  scene.cutting = Cutting{.smallest_piece = 1e-9, .where = "test"};
  scene.deformation.of<RayleighDamping>().stiffness = 1e-4;
  scene.deformation.of<RayleighDamping>().mass = 0;
  return scene;
}

/// The right half of the block, loose.
struct LooseHalf {
  Simulation simulation;
  explicit LooseHalf(std::string_view model)
      : simulation(loose_scene(model), soft_block(Vec3(0.04, 0.02, 0.04), {8, 4, 8})) {
    std::vector<Removal> slice;
    for (int t = 0; t < static_cast<int>(simulation.mesh().tetrahedra.size()); ++t) {
      const double x =
          centre_of(simulation.mesh(), simulation.mesh().tetrahedra[static_cast<std::size_t>(t)]).x();
      if (x > 0 && x < 0.005) slice.push_back({kShortStep, t});
    }
    simulation.set_cut_options({.planned = slice});
  }
  bool is_loose(int vertex) const { return simulation.rest()[static_cast<std::size_t>(vertex)].x() > 0.0049; }
  double volume() const {
    double sum = 0;
    const auto at = [&](int v) { return simulation.positions()[static_cast<std::size_t>(v)]; };
    for (const Triangle& t : simulation.surface().triangles) {
      if (is_loose(t[0])) sum += at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6;
    }
    return sum;
  }
  /// Cosine of the angle between an edge at rest and where it is.
  double cosine() const {
    Vec3 rest = Vec3::Zero(), now = Vec3::Zero();
    for (const Triangle& t : simulation.surface().triangles) {
      for (const int v : t) {
        const Vec3& x = simulation.rest()[static_cast<std::size_t>(v)];
        if (!is_loose(v) || std::abs(x.z()) < 0.0199) continue;
        rest += (x.z() > 0 ? 1 : -1) * x;
        now += (x.z() > 0 ? 1 : -1) * simulation.positions()[static_cast<std::size_t>(v)];
      }
    }
    return rest.normalized().dot(now.normalized());
  }
};

}  // namespace

TEST_CASE("a loose half that is nudged keeps its volume, however far it turns") {
  const std::string model = GENERATE("tensor_mass", "hybrid", "implicit");
  CAPTURE(model);
  LooseHalf half(model);
  step(half.simulation, Vec3(0.0125, 0.02, 0.015), {}, kShortStep);
  const double volume = 0.015 * 0.02 * 0.04;  // m^3
  double smallest = 1, largest = 1, turned = 1;
  for (int i = 1; i < 500; ++i) {
    // Down on one end of it, 0.2 m/s, 12 mm deep; then lifted.
    std::vector<ToolInput> inputs(1);
    const double height = std::max(0.010 - 1e-3 * i, -0.012);
    if (i < 40) inputs[0].pose = ToolPose(Vec3(0.0125, height, 0.015));
    half.simulation.step(inputs, kShortStep);
    if (i < 3) continue;
    REQUIRE(half.simulation.resection()->totals().loose_pieces == 1);
    if (i < 45) continue;  // pressed
    smallest = std::min(smallest, half.volume() / volume);
    largest = std::max(largest, half.volume() / volume);
    turned = std::min(turned, half.cosine());
  }
  CHECK(turned < -0.9);
  CHECK(smallest > 0.99);
  CHECK(largest < 1.01);
  CHECK(half.simulation.flagged().to_text().empty());
}
