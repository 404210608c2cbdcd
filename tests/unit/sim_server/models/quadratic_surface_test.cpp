// Loads on the surface of a body of quadratic elements, whose nodes are also in the middle of edges.
#include <map>

#include "sim_server/elasticity/solid.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/models/implicit.h"
#include "sim_server/models/reduced.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kLong = 0.03, kArea = 0.02 * 0.025;  // m, m^2
const Material kTissue{5e3, 0, 1000, ElasticLaw::kLinear, ElementKind::kQuadratic};

/// A bar held where x = 0, all of its surface in reach.
struct Bar {
  TetMesh mesh = with_nodes(grid_block({0, 0.01, 0.02, kLong}, {0, 0.01, 0.02}, {0, 0.012, 0.025}),
                            ElementKind::kQuadratic);
  Surface surface = boundary_surface(mesh);
  Scene scene = test::scene_of(kTissue, {Vec3(-1, -1, -1), Vec3(0, 1, 1)}, 0.005);
  std::vector<int> fixed = fixed_vertices(scene, mesh), reachable;

  Bar() {
    for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) reachable.push_back(v);
    scene.rate_hz = 30;
    scene.deformation.of<ReducedSettings>().modes = 12;
    scene.deformation.of<ImplicitSettings>().tolerance = 1e-12;
    scene.deformation.of<RayleighDamping>().mass = 20;
    scene.deformation.of<RayleighDamping>().stiffness = 0.02;  // it creeps to where the load leads
  }
  const Vec3& rest(int v) const { return mesh.vertices[surface.vertices[v]]; }

  /// A pull (N) along the bar, even over its free end: of a quadratic triangle a third on each middle and
  /// nothing on the corners (Zienkiewicz and Taylor 2000, volume 1, chapter 8).
  std::vector<VertexLoad> pulled(double force) const {
    std::map<int, double> fraction;  // of the area of the end
    for (std::size_t i = 3; i < surface.triangles.size(); i += 4) {
      const Triangle& middle = surface.triangles[i];
      const Vec3 a = rest(middle[0]), area = 2 * (rest(middle[1]) - a).cross(rest(middle[2]) - a);
      if (a[0] < kLong || rest(middle[1])[0] < kLong || rest(middle[2])[0] < kLong) continue;
      for (const int v : middle) fraction[v] += area.norm() / 3;
    }
    std::vector<VertexLoad> loads;
    for (const auto& [v, area] : fraction) loads.push_back({v, force * area / kArea * Vec3::UnitX()});
    return loads;
  }
};

}  // namespace

TEST_CASE("a bar of quadratic elements, pulled evenly at its surface, gets longer by F L / (E A)") {
  Bar bar;
  constexpr double kPull = 0.02;
  const std::vector<VertexLoad> loads = bar.pulled(kPull);
  REQUIRE(loads.size() == 16);  // sides and diagonals of 2 x 2 squares: 12 and 4
  const double longer = kPull * kLong / (kTissue.young_modulus * kArea);
  int models = 0;
  for (const DeformationModelRow& row : models_without_cutting()) {
    if (row.materials < Materials::kLinear) continue;
    ++models;
    bar.scene.deformation.model = row.name;
    const auto model = row.make(
        {bar.scene, bar.mesh, bar.surface, bar.fixed, bar.reachable, [](std::string_view, double) {}});
    std::span<const Vec3> moved;
    for (int step = 0; step < 300; ++step) {
      model->free_motion(1 / bar.scene.rate_hz);
      moved = model->apply(loads);
    }
    REQUIRE(moved.size() == bar.surface.vertices.size());
    for (int v = 0; v < static_cast<int>(moved.size()); ++v) {
      const Vec3 expected = bar.rest(v) + longer * bar.rest(v)[0] / kLong * Vec3::UnitX();
      CAPTURE(row.name, v);
      CHECK((moved[v] - expected).norm() < 1e-9 * longer);
    }
  }
  CHECK(models >= 2);
}

TEST_CASE("what the scene fixes of a body of quadratic elements holds the middle of an edge between two") {
  Bar bar;
  // 3 x 3 corners where x = 0, and the middles of the 12 sides and 4 diagonals of its squares.
  REQUIRE(bar.fixed.size() == 9 + 16);
  for (const int vertex : bar.fixed) CHECK(bar.mesh.vertices[vertex][0] == 0);
}
