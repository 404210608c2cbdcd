#include "sim_server/simulation/error_of_force.h"

#include <numbers>

#include "sim_server/study/studied_errors.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
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

TEST_CASE(
    "error of the force: a study takes the place of estimates, as long as scene and mesh are the same") {
  const test::TemporaryFolder folder;
  const SetupCache cache(folder.path() / "cache");
  Scene scene = test::liver_scene();
  scene.tools.push_back(scene.tools.front());  // the study pressed with the first alone
  scene.source = folder.write("scene.toml", "rate_hz = 30").string();
  CHECK_FALSE(find_studied(cache, scene));
  keep_studied(cache, scene, {{ErrorSource::kMeasured, 12.5F}, {ErrorSource::kMeasured, 0.25F}}, 60);
  const auto found = find_studied(cache, scene);
  REQUIRE(found);
  CHECK(found->mesh.percent == 12.5F);
  CHECK(found->time_step.percent == 0.25F);
  const Simulation simulation(scene);
  const std::vector<VertexLoad> loads{pressed_at_top(simulation)};
  const DiscretisationErrors errors = ErrorOfForce(scene, simulation, found).of_step(0, loads);
  CHECK(errors.mesh.source == ErrorSource::kMeasured);
  CHECK(errors.mesh.percent == 12.5F);
  CHECK(errors.time_step.source == ErrorSource::kNone);  // this scene makes none
  CHECK(ErrorOfForce(scene, simulation, found).of_step(1, loads).mesh.source == ErrorSource::kEstimated);
  scene.tools.front().grasp_buttons = 1;  // the study held nothing
  CHECK(ErrorOfForce(scene, simulation, found).of_step(0, loads).mesh.source == ErrorSource::kUnknown);
  folder.write("scene.toml", "rate_hz = 31");
  CHECK_FALSE(find_studied(cache, scene));
}

TEST_CASE(
    "error of the force: of linear elements that bend or lock it is not known how far the mesh is off") {
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
  CHECK(source(1, 0.3, false, kLinear) == ErrorSource::kUnknown);
  CHECK(source(2, 0.3, false, kLinear) == ErrorSource::kUnknown);
  CHECK(source(4, 0.3, false, kLinear) == ErrorSource::kEstimated);
  CHECK(source(1, 0.3, true, kLinear) == ErrorSource::kEstimated);  // it rests on what does not move
  CHECK(source(4, 0.4999, false, kLinear) == ErrorSource::kUnknown);
  CHECK(source(4, 0.48, false, kLinear) == ErrorSource::kEstimated);
}
