#include "sim_server/simulation/error_of_force.h"

#include <fmt/core.h>
#include <functional>
#include <numbers>

#include "sim_server/simulation/element_trial.h"
#include "sim_server/study/studied_errors.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/solids.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kRadius = 0.005;

/// Two equilateral triangles apart from each other, with edges of h and of 2 h.
struct TwoTriangles {
  double h = 0.002;
  Surface surface{{0, 1, 2, 3, 4, 5}, {{0, 1, 2}, {3, 4, 5}}, 1};
  std::vector<Vec3> rest;
  TwoTriangles() {
    for (const double edge : {h, 2 * h}) {
      for (const double angle : {0.0, 2 * std::numbers::pi / 3, 4 * std::numbers::pi / 3})
        rest.push_back(edge / std::sqrt(3) * Vec3(std::cos(angle), std::sin(angle), 0));
    }
  }
};

/// A figure that is no more than half as much again as another, nor less by as much.
Approx within_half(double right) {
  return Approx(right).epsilon(0).margin(right / 3);
}

constexpr double kModulus = 1e5;  // Pa, of sheets and beams

/// What a press by 0.4 radii costs by theory, and what is told of it.
struct PressedTissue {
  double too_stiff = 0;  // its force by that of a thin sheet or beam
  DiscretisationError told;

  void press(const Scene& scene, Simulation& simulation, const Vec3& surface, double stiffness) {
    const double depth = 0.4 * kRadius;
    const ToolForce force = simulation.step(ToolPose(surface + Vec3(0, kRadius - depth, 0)), 1);
    too_stiff = force.force.norm() / (stiffness * depth);
    told = ErrorOfForce(scene, simulation).of_step(0, simulation.loads(0)).mesh;
  }
};

/// 60 x 2 x 60 mm in so many cells, clamped all around, pressed in the middle: P = w D / (0.0056 a^2), D = E
/// t^3 / 12 / (1 - nu^2) (Timoshenko and Woinowsky-Krieger 1959, Theory of Plates and Shells, table 35).
struct PressedSheet : PressedTissue {
  PressedSheet(double poisson_ratio, const std::array<int, 3>& cells) {
    constexpr double kSide = 0.06, kThick = 0.002;
    Scene scene = test::scene_of({.young_modulus = kModulus, .poisson_ratio = poisson_ratio},
                                 {Vec3(-1, -1, -1), Vec3(1e-4, 1, 1)}, kRadius);
    const auto hold = [&](const Vec3& min, const Vec3& max) {
      FixedRegion fixed;
      fixed.box = Box{min, max};
      scene.fixed.push_back(fixed);
    };
    hold({kSide - 1e-4, -1, -1}, {1, 1, 1});
    hold({-1, -1, -1}, {1, 1, 1e-4});
    hold({-1, -1, kSide - 1e-4}, {1, 1, 1});
    Simulation simulation(scene, test::corner_block({kSide, kThick, kSide}, cells));
    press(
        scene, simulation, {kSide / 2, kThick, kSide / 2},
        kModulus * std::pow(kThick, 3) / 12 / (1 - poisson_ratio * poisson_ratio) / (0.0056 * kSide * kSide));
  }
};

/// 80 mm long and 4 mm wide in so many cells, clamped at x = 0, pressed at the end: w / P is the integral of
/// (L - x)^2 / (E I) over it (Euler and Bernoulli).
struct PressedBeam : PressedTissue {
  PressedBeam(
      double poisson_ratio, const std::array<int, 3>& cells,
      const std::function<double(double)>& thickness = [](double) { return 0.004; }) {
    constexpr double kLength = 0.08, kWide = 0.004, kStep = 1e-5;
    const Scene scene = test::scene_of({.young_modulus = kModulus, .poisson_ratio = poisson_ratio},
                                       {Vec3(-1, -1, -1), Vec3(1e-6, 1, 1)}, kRadius);
    double yields = 0;
    for (double x = kStep / 2; x < kLength; x += kStep)
      yields += kStep * std::pow(kLength - x, 2) / (kModulus * kWide * std::pow(thickness(x), 3) / 12);
    Simulation simulation(scene,
                          test::mapped(test::corner_block({kLength, 1, kWide}, cells), [&](const Vec3& x) {
                            return Vec3(x.x(), (x.y() - 1) * thickness(x.x()), x.z());
                          }));
    press(scene, simulation, {kLength, 0, kWide / 2}, 1 / yields);
  }
};

/// Where the liver is thick.
VertexLoad pressed_at_top(const Simulation& simulation) {
  const auto top = std::ranges::max_element(simulation.rest(), {}, [](const Vec3& x) { return x.y(); });
  return {static_cast<int>(top - simulation.rest().begin()), {0, -1, 0}};
}

}  // namespace

TEST_CASE("mesh resolution: the radius over the edges that meet where the tool presses, by its loads") {
  const TwoTriangles two;
  MeshResolution mesh(two.surface, two.rest, kRadius);
  CHECK_FALSE(mesh.elements_per_radius());
  CHECK_FALSE(mesh.of(std::span<const VertexLoad>{}));
  const std::vector<VertexLoad> fine{{0, {0, 3, 0}}}, coarse{{4, {0, 0, 1}}};
  CHECK(*mesh.of(fine) == Approx(kRadius / two.h));
  CHECK(*mesh.of(coarse) == Approx(kRadius / (2 * two.h)));
  mesh.add(fine), mesh.add(coarse);
  CHECK(*mesh.elements_per_radius() == Approx((3 * 2.5 + 1.25) / 4));
  CHECK(*mesh.finest(two.surface.triangles) == Approx(2.5));
  CHECK(*mesh.finest(std::span(two.surface.triangles).subspan(1)) == Approx(1.25));
  CHECK_FALSE(mesh.finest({}));
}

TEST_CASE("mesh resolution: where edges have a vertex in their middle, an element is what the edge spans") {
  TwoTriangles two;
  two.surface.per_face = 4;  // these are the quarters of faces with edges twice as long
  CHECK(*MeshResolution(two.surface, two.rest, kRadius).of(std::vector<VertexLoad>{{0, {1, 0, 0}}}) ==
        Approx(kRadius / (2 * two.h)));
}

TEST_CASE("mesh resolution: a copy of a vertex, of which nothing is known, tells nothing") {
  TwoTriangles two;
  two.rest.push_back(two.rest[0]);
  two.surface.vertices.push_back(6);  // of no triangle yet
  const MeshResolution mesh(two.surface, two.rest, kRadius);
  CHECK_FALSE(mesh.of(std::vector<VertexLoad>{{6, {0, 1, 0}}}));
  CHECK(*mesh.of(std::vector<VertexLoad>{{0, {0, 1, 0}}, {6, {0, 1, 0}}}) == Approx(kRadius / two.h));
}

TEST_CASE("error of the force: friction and tissue in motion depend on the steps taken, the others do not") {
  const auto source = [](const std::string& model, double friction) {
    Scene scene = test::liver_scene();
    scene.deformation.model = model;
    scene.tools.front().shape.friction = friction;
    const Simulation simulation(scene);
    const std::vector<VertexLoad> loads{pressed_at_top(simulation)};
    const DiscretisationErrors errors = ErrorOfForce(scene, simulation).of_step(0, loads);
    CHECK(errors.mesh.source == ErrorSource::kEstimated);
    CHECK(errors.mesh.percent >
          29);  // p1, less than four elements to a radius: the table of tests/studies/RESULTS.md
    CHECK(errors.time_step.percent == 0);
    return errors.time_step.source;
  };
  CHECK(source("quasi_static", 0) == ErrorSource::kNone);
  CHECK(source("quasi_static", 0.3) == ErrorSource::kUnknown);
  CHECK(source("tensor_mass", 0) == ErrorSource::kUnknown);
}

TEST_CASE("error of the force: a study holds where it pressed and as hard, as long as scene and mesh stay") {
  const test::TemporaryFolder folder;
  const SetupCache cache(folder.path() / "cache");
  Scene scene = test::liver_scene();
  scene.tools.push_back(scene.tools.front());  // the study pressed with the first alone
  scene.source = folder.write("scene.toml", "rate_hz = 30").string();
  const Simulation simulation(scene);
  const VertexLoad top = pressed_at_top(simulation);
  const double radius = scene.tools.front().shape.radius;
  const Vec3 place = simulation.rest()[static_cast<std::size_t>(top.vertex)] + Vec3(0, 0.9 * radius, 0);
  CHECK_FALSE(find_studied(cache, scene));
  keep_studied(cache, scene,
               {.errors = {{ErrorSource::kMeasured, 12.5F}, {ErrorSource::kMeasured, 0.25F}},
                .pressed = {place, place},
                .most_newton = 0.8},
               60);
  const auto found = find_studied(cache, scene);
  REQUIRE(found);
  CHECK(found->errors.mesh.percent == 12.5F);
  CHECK(found->errors.time_step.percent == 0.25F);
  CHECK(found->pressed.min == place);
  CHECK(found->pressed.max == place);
  CHECK(found->most_newton == 0.8);
  const ErrorOfForce of_force(scene, simulation, found);
  const auto source = [&](const ErrorOfForce& errors, std::size_t tool, const VertexLoad& load) {
    return errors.of_step(tool, std::span(&load, 1)).mesh.source;
  };
  CHECK(of_force.of_step(0, std::span(&top, 1)).mesh.percent == 12.5F);
  CHECK(source(of_force, 0, top) == ErrorSource::kMeasured);  // 1 N, 1.25 times as hard
  CHECK(of_force.of_step(0, std::span(&top, 1)).time_step.source == ErrorSource::kNone);  // it makes none
  CHECK(source(of_force, 1, top) == ErrorSource::kEstimated);
  CHECK(source(of_force, 0, {top.vertex, {0, -1.21, 0}}) == ErrorSource::kEstimated);  // 1.51 times
  for (std::size_t v = 0; v < simulation.rest().size(); ++v) {
    const Vec3 away = (simulation.rest()[v] - place).cwiseAbs();
    if (std::abs(away.maxCoeff() - radius) < 1e-9 * radius) continue;
    CHECK((source(of_force, 0, {static_cast<int>(v), {0, -1, 0}}) == ErrorSource::kMeasured) ==
          (away.maxCoeff() < radius));
  }
  scene.tools.front().grasp_buttons = 1;  // the study held nothing
  CHECK(source(ErrorOfForce(scene, simulation, found), 0, top) == ErrorSource::kUnknown);
  folder.write("scene.toml", "rate_hz = 31");
  CHECK_FALSE(find_studied(cache, scene));
}

TEST_CASE("error of the force: a study has pressed where its tool felt a force, as hard as its largest") {
  Trace trace;
  trace.places = {{0, 0.03, 0}, {0, 0.02, 0.001}, {0.004, 0.01, 0}, {0.009, 0.05, 0}};
  trace.forces = {{0, 0, 0}, {0, 0.5, 0}, {0, 0.3, 0.4 * std::sqrt(2)}, {0, 1e-9, 0}};
  const auto pressed = pressed_in(trace);
  REQUIRE(pressed);
  CHECK(pressed->pressed.min == Vec3(0, 0.01, 0));
  CHECK(pressed->pressed.max == Vec3(0.004, 0.02, 0.001));
  CHECK(pressed->most_newton == Approx(std::sqrt(0.41)));
  trace.forces.assign(4, Vec3::Zero());
  CHECK_FALSE(pressed_in(trace));
}

TEST_CASE(
    "error of the force: of linear elements that bend or lock the table does not say how far the mesh is "
    "off") {
  // A plate of 60 x 60 mm with edges of 3 mm, so many layers thick, held at its rim or on its whole lower
  // side; pressed in the middle of its upper side.
  const auto source = [](int layers, double poisson_ratio, bool lies, ElementKind element) {
    const double thickness = 0.003 * layers;
    Scene scene = test::scene_of({.young_modulus = 1e4, .poisson_ratio = poisson_ratio, .element = element},
                                 {Vec3(-1, -1, -1), lies ? Vec3(1, 1e-4, 1) : Vec3(1e-4, 1, 1)}, kRadius);
    const Simulation simulation(scene, test::corner_block({0.06, thickness, 0.06}, {20, layers, 20}));
    std::vector<VertexLoad> loads;
    for (std::size_t k = 0; k < simulation.rest().size(); ++k) {
      if ((simulation.rest()[k] - Vec3(0.03, thickness, 0.03)).norm() < 0.0015)
        loads.push_back({static_cast<int>(k), {0, -1, 0}});
    }
    REQUIRE(!loads.empty());
    return ErrorOfForce(scene, simulation).of_step(0, loads).mesh.source;
  };
  using enum ElementKind;
  CHECK(source(1, 0.3, false, kLinear) == ErrorSource::kEstimated);  // by a press on quadratic ones
  CHECK(source(2, 0.3, false, kLinear) == ErrorSource::kUnknown);
  CHECK(source(4, 0.3, false, kLinear) == ErrorSource::kEstimated);
  CHECK(source(1, 0.3, true, kLinear) == ErrorSource::kEstimated);  // it rests on what does not move
  CHECK(source(4, 0.4999, false, kLinear) == ErrorSource::kUnknown);
  CHECK(source(4, 0.48, false, kLinear) == ErrorSource::kEstimated);
}

TEST_CASE("error of the force: of a sheet of one layer that bends, a trial finds what plate theory says") {
  const PressedSheet sheet(0.3, {20, 1, 20});
  CAPTURE(sheet.too_stiff, sheet.told.percent);
  CHECK(sheet.told.source == ErrorSource::kEstimated);
  CHECK(sheet.too_stiff > 4);
  CHECK(1 + sheet.told.percent / 100 == Approx(sheet.too_stiff).epsilon(0.2));
}

TEST_CASE(
    "error of the force: of sheets of some layers, what is told is what plate theory says, or nothing") {
  const int layers = GENERATE(2, 3, 4, 6);
  const double poisson_ratio = GENERATE(0.3, 0.45);
  const PressedSheet sheet(poisson_ratio, {10, layers, 10});
  const double right = 100 * (sheet.too_stiff - 1);
  CAPTURE(layers, poisson_ratio, right, sheet.told.percent);
  CHECK(right > 600);
  CHECK(sheet.told.source == ErrorSource::kEstimated);
  CHECK(sheet.told.percent == within_half(right));
  // Of twice as many cells along each side quadratic elements are too large to try.
  if (poisson_ratio == 0.3)
    CHECK(PressedSheet(poisson_ratio, {20, layers, 20}).told.source == ErrorSource::kUnknown);
}

TEST_CASE("error of the force: of beams of some layers, what is told is what beam theory says, or nothing") {
  const int layers = GENERATE(2, 3, 4, 6);
  const double poisson_ratio = GENERATE(0.3, 0.45);
  const PressedBeam beam(poisson_ratio, {10, layers, layers});
  const double right = 100 * (beam.too_stiff - 1);
  CAPTURE(layers, poisson_ratio, right, beam.told.percent);
  CHECK(right > 400);
  CHECK(beam.told.source == ErrorSource::kEstimated);
  CHECK(beam.told.percent == within_half(right));
}

TEST_CASE("error of the force: of a slender beam that is too large to try, no small number is told") {
  const PressedBeam beam(0.45, {80, 4, 4});
  CAPTURE(beam.told.percent);
  CHECK(beam.too_stiff > 1.5);
  CHECK(beam.told.source == ErrorSource::kUnknown);
}

TEST_CASE("error of the force: nothing is tried with a tool that reaches most of an organ of many vertices") {
  constexpr double kLarge = 0.03;
  const Scene scene =
      test::scene_of({.young_modulus = kModulus}, {Vec3(-1, -1, -1), Vec3(1, 1e-4, 1)}, kLarge);
  const TetMesh mesh =
      test::corner_block({0.06, 0.002, 0.06}, {20, 1, 20});  // 882 vertices, 4 times as many nodes
  CHECK(try_elements(scene, mesh).presses.empty());
  Scene small = scene;
  small.tools[0].shape.radius = kRadius;
  CHECK(try_elements(small, mesh).presses.size() > 1);
}

TEST_CASE("error of the force: where nothing is pressed on, the reason is told, and what to change") {
  const TetMesh mesh = test::corner_block({0.03, 0.01, 0.03}, {6, 2, 6});
  const Scene scene =
      test::scene_of({.young_modulus = kModulus}, {Vec3(-1, -1, -1), Vec3(1, 1e-4, 1)}, kRadius);
  const auto why = [](const Scene& each, const TetMesh& on) {
    const ElementTrials trials = try_elements(each, on);
    CHECK(trials.presses.empty() != trials.why_none.empty());
    return trials.why_none;
  };
  using Catch::Contains;
  CHECK(why(scene, mesh).empty());
  Scene other = scene;
  other.material->element = ElementKind::kQuadratic;
  CHECK_THAT(why(other, mesh), Contains("does not have \"p1\""));
  other = scene;
  other.cutting = Cutting{.where = "test"};
  CHECK_THAT(why(other, mesh), Contains("without [cutting]"));
  other = scene;
  other.tools[0].grasp_buttons = 1;
  CHECK_THAT(why(other, mesh), Contains("a [[tool]] that presses first"));
  other = scene;
  other.tools[0].reach = Box{Vec3(5, 5, 5), Vec3(6, 6, 6)};
  CHECK_THAT(why(other, mesh), Contains("reaches no surface; move its `reach`"));
  other = scene;
  other.tools[0].shape.radius = 0.1;
  CHECK_THAT(why(other, test::corner_block({0.06, 0.002, 0.06}, {20, 1, 20})),
             Contains("reaches more than 300 vertices at once"));
  // Nodes of quadratic elements lie on a lattice of half the cells' size: 2 n + 1 along each side.
  const std::array<int, 3> fine{16, 6, 16};
  const int nodes = (2 * fine[0] + 1) * (2 * fine[1] + 1) * (2 * fine[2] + 1);
  CHECK_THAT(why(scene, test::corner_block({0.03, 0.01, 0.03}, fine)),
             Contains(fmt::format("would have {} nodes on this mesh, and up to 6000 are tried", nodes)) &&
                 Contains("sim_server study"));
}

TEST_CASE("error of the force: where a thick beam ends in a thin one, the press on that counts") {
  const auto thickness = [](double x) { return x < 0.04 ? 0.012 : 0.002; };
  const PressedBeam beam(0.3, {20, 2, 4}, thickness);
  const double right = 100 * (beam.too_stiff - 1);
  CAPTURE(right, beam.told.percent);
  CHECK(right > 300);
  CHECK(beam.told.source == ErrorSource::kEstimated);
  CHECK(beam.told.percent == within_half(right));
}

TEST_CASE(
    "error of the force: of elements that lock, a trial finds what a finer mesh of quadratic ones says") {
  Scene scene = test::deep_block_scene("quasi_static");
  scene.material->poisson_ratio = 0.4999;
  Simulation simulation(scene, test::deep_block());
  const ToolPose pose(Vec3(0, 0.6 * kRadius, 0));
  const double locked = simulation.step(pose, 1).force.norm();
  Scene finer = scene;
  finer.material->element = ElementKind::kQuadratic;
  finer.tools[0].reach = Box{Vec3(-0.011, -0.001, -0.011), Vec3(0.011, 0.001, 0.011)};
  const double right = Simulation(finer, test::deep_block({16, 8, 16})).step(pose, 1).force.norm();
  const DiscretisationErrors errors = ErrorOfForce(scene, simulation).of_step(0, simulation.loads(0));
  CAPTURE(locked / right, errors.mesh.percent);
  CHECK(errors.mesh.source == ErrorSource::kEstimated);
  CHECK(locked > 1.5 * right);
  CHECK(1 + errors.mesh.percent / 100 == Approx(locked / right).epsilon(0.25));
}
