// A piece that a cut has made loose, and a tool pushes: it flies and turns as a body, in each linear model.
#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

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

/// A block held at its left side, which can be cut up to `end` (m along x).
Scene loose_scene(std::string_view model, double end) {
  Scene scene = soft_block_scene(0.02, model, ElasticLaw::kLinear, 0.004);
  scene.fixed[0].box = {Vec3(-1, -1, -1), Vec3(-0.0199, 1, 1)};
  scene.rate_hz = 1 / kShortStep;
  scene.cutting = Cutting{.smallest_piece = 1e-9, .where = "test"};
  if (end < 0.02) scene.cutting->region = Region{Box{Vec3(-0.001, -1, -1), Vec3(end, 1, 1)}, "", "test"};
  scene.deformation.of<RayleighDamping>().stiffness = 1e-4;
  scene.deformation.of<RayleighDamping>().mass = 0;
  return scene;
}

/// The right half of the block, loose.
struct LooseHalf {
  Simulation simulation;
  explicit LooseHalf(std::string_view model, double end = 1) : LooseHalf(loose_scene(model, end)) {}
  explicit LooseHalf(const Scene& scene) : simulation(scene, soft_block(Vec3(0.04, 0.02, 0.04), {8, 4, 8})) {
    std::vector<Removal> slice;
    for (int t = 0; t < static_cast<int>(simulation.mesh().tetrahedra.size()); ++t) {
      const double x =
          centre_of(simulation.mesh(), simulation.mesh().tetrahedra[static_cast<std::size_t>(t)]).x();
      if (x > 0 && x < 0.005) slice.push_back({0, t});
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

TEST_CASE(
    "the lobe of liver_scalpel.toml, let go, pushed and turned round, keeps its volume, however far it "
    "turns") {
  const Scene scene = example_scene("liver_scalpel");
  Simulation simulation(scene);
  const double plane = scene.cutting->plan->point.x(), step_length = 1 / scene.rate_hz;
  std::vector<Removal> slice;
  for (std::size_t t = 0; t < simulation.mesh().tetrahedra.size(); ++t) {
    int beyond = 0;
    for (const int v : simulation.mesh().tetrahedra[t])
      beyond += simulation.mesh().vertices[static_cast<std::size_t>(v)].x() > plane ? 1 : 0;
    if (beyond > 0 && beyond < 4) slice.push_back({step_length, static_cast<int>(t)});
  }
  simulation.set_cut_options({.planned = slice});
  const auto volume = [&](std::span<const Vec3> x) {
    double sum = 0;
    for (const Triangle& t : simulation.surface().triangles) {
      const auto at = [&](int k) { return x[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]; };
      if (simulation.rest()[static_cast<std::size_t>(t[0])].x() > plane)
        sum += at(0).dot(at(1).cross(at(2))) / 6;
    }
    return sum;
  };
  const auto x_of = [&](std::size_t v) { return simulation.rest()[v].x(); };
  std::size_t tip = 0, stump = 0;  // vertices of the lobe, farthest from the plane and nearest to it
  for (std::size_t v = 0; v < simulation.rest().size(); ++v) {
    if (x_of(v) > x_of(tip)) tip = v;
    if (x_of(v) > plane && (x_of(stump) <= plane || x_of(v) < x_of(stump))) stump = v;
  }
  const auto axis = [&](std::span<const Vec3> x) { return (x[tip] - x[stump]).normalized(); };
  const Vec3 end = simulation.rest()[tip];
  double smallest = 1, largest = 1, cosine = 1;
  ToolPose hand;
  for (int i = 0; i < 300; ++i) {
    std::vector<ToolInput> inputs(2);
    // Down beside its tip, 0.3 m/s, and lifted; then jaws hold the tip, and turn it all the way round in 4 s.
    if (i < 9) inputs[1].pose = ToolPose(end + Vec3(-0.004, 0.03 - 0.01 * i, 0));
    if (i == 100) hand = ToolPose(simulation.positions()[tip]);
    if (i >= 100 && i < 240) {
      hand.q_W = Quat(Eigen::AngleAxisd(2 * std::numbers::pi * std::clamp((i - 110) / 120.0, 0.0, 1.0),
                                        Vec3(1, 1, 2).normalized()));
      inputs[1].pose = hand;
      inputs[1].buttons = 1;
    }
    simulation.step(inputs, step_length);
    if (i < 11) continue;  // pressed
    REQUIRE(simulation.resection()->totals().loose_pieces == 1);
    const double ratio = volume(simulation.positions()) / volume(simulation.rest());
    smallest = std::min(smallest, ratio);
    largest = std::max(largest, ratio);
    cosine = std::min(cosine, axis(simulation.positions()).dot(axis(simulation.rest())));
  }
  CAPTURE(smallest, largest, cosine);
  CHECK(cosine < -0.3);
  CHECK(smallest > 0.99);
  CHECK(largest < 1.01);
  CHECK(simulation.flagged().to_text().empty());
}

TEST_CASE("a loose half that is nudged keeps its volume, however far it turns") {
  const auto [model, end] = GENERATE(table<std::string, double>(
      {{"tensor_mass", 1}, {"hybrid", 1}, {"implicit", 1}, {"hybrid", 0.006} /* most of it is condensed */}));
  CAPTURE(model, end);
  LooseHalf half(model, end);
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

TEST_CASE("tissue that is still held is judged inside out though a piece is loose") {
  const std::string model = GENERATE("tensor_mass", "hybrid", "implicit");
  CAPTURE(model);
  LooseHalf half(model);
  step(half.simulation, Vec3(-0.005, 0.02, 0), {}, kShortStep);
  ToolAnswer answer;
  // Into what is held, aslant, by 1.4 mm a step; a strain beyond 3 would tell it, too, but later.
  for (int i = 1; i < 48 && !answer.flagged; ++i) {
    answer = step(half.simulation, Vec3(-0.005 - 1e-3 * i, 0.006 - 1e-3 * i, 0.0007), {}, kShortStep);
    REQUIRE(half.simulation.resection()->totals().loose_pieces == 1);
  }
  CHECK(answer.flagged);
  CHECK(answer.doubt == Doubt::kInsideOut);
  CHECK(half.simulation.tool(0).surface_strain(half.simulation.positions(), half.simulation.rest()) < 3);
}

TEST_CASE("jaws that take a loose piece away are not judged by the tissue between, which is gone") {
  Scene scene = loose_scene("tensor_mass", 1);
  const Vec3 place(0.0075, 0.002, 0.0005);
  scene.tools[0].grasp_place = place;
  LooseHalf half(scene);
  for (int i = 0; i < 200; ++i) {
    const ToolAnswer answer = step(half.simulation, place + Vec3(1.5e-4 * i, 0, 0), {}, kShortStep);
    REQUIRE(half.simulation.resection()->totals().loose_pieces == 1);
    REQUIRE(answer.contacts > 0);
  }
  CHECK(half.simulation.flagged().to_text().empty());
  CHECK(half.simulation.strain()->to_json()["largest"] < 0.5);
}

TEST_CASE("tissue that is still held runs away though a piece is loose, and the piece alone does not") {
  const double gravity = GENERATE(9.81, -2e6);  // m/s^2, along y
  Scene scene = loose_scene("implicit", 1);
  scene.loads = {{.kind = Load::Kind::kGravity, .vector = Vec3(0, gravity, 0)}};
  LooseHalf half(scene);
  ToolAnswer answer;
  double highest = 0;
  for (int i = 0; i < 100 && !answer.flagged; ++i) {
    answer = step(half.simulation, Vec3(-0.015, 1, 0), {}, kShortStep);
    for (const Vec3& x : half.simulation.positions()) highest = std::max(highest, x.y());
  }
  if (gravity > 0) {
    CHECK_FALSE(answer.flagged);
    CHECK(highest > 1);  // g t^2 / 2 = 1.2 m: the piece is far beyond three sizes of the block
  } else {
    CHECK(answer.doubt == Doubt::kRanAway);
  }
}
