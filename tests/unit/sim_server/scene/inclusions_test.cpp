// Tissue that is not everywhere as stiff.
#include "sim_server/scene/inclusions.h"

#include "common/error.h"
#include "sim_server/elasticity/solid.h"
#include "sim_server/elasticity/tensors.h"
#include "sim_server/mesh/refinement.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// A bar of four cubes along x, of 10 mm each.
TetMesh bar() {
  return grid_block(test::lines(0, 0.04, 4), {0, 0.01}, {0, 0.01});
}

Inclusion between(double from, double to, double young_modulus) {
  Inclusion inclusion;
  inclusion.where = "test:7";
  inclusion.box = Box{{from, -1, -1}, {to, 1, 1}};
  inclusion.young_modulus = young_modulus;
  return inclusion;
}

Scene bar_with(std::vector<Inclusion> inclusions) {
  Scene scene =
      test::scene_of({.young_modulus = 1e4, .poisson_ratio = 0.3}, {Vec3(-1, -1, -1), Vec3(0, 1, 1)}, 0.004);
  scene.inclusions = std::move(inclusions);
  return scene;
}

/// Of a displacement, by both of the programs' ways to have it: the stiffness times it.
double disagreement(const TetMesh& mesh, const Material& material) {
  const Solid solid(mesh, material);
  const ElasticTensors tensors(mesh, material, {});
  test::Random random(3);
  std::vector<Vec3> x = solid.rest(), f(x.size());
  std::vector<double> u(3 * x.size()), y(u.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 moved = random.vector(1e-4);
    x[i] += moved;
    Eigen::Map<Vec3>(u.data() + 3 * tensors.places()[i]) = moved;
  }
  solid.forces(x, f);
  tensors.multiply(u.data(), y.data());
  double most = 0, size = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    most = std::max(most, (f[i] - Eigen::Map<const Vec3>(y.data() + 3 * tensors.places()[i])).norm());
    size = std::max(size, f[i].norm());
  }
  return most / size;
}

}  // namespace

TEST_CASE(
    "inclusions: a tetrahedron belongs to the last one that holds its centroid, with all of its children") {
  TetMesh mesh = bar();
  put_inclusions(bar_with({between(0.01, 0.03, 5e4), between(0.02, 0.04, 2e3)}), mesh);
  REQUIRE(mesh.stiffness.size() == mesh.tetrahedra.size());
  const TetMesh fine = refined(mesh);
  for (const TetMesh* one : {&std::as_const(mesh), &fine}) {
    for (std::size_t e = 0; e < one->tetrahedra.size(); ++e) {
      double x = 0;
      for (const int v : one->tetrahedra[e]) x += one->vertices[v][0] / 4;
      CHECK(one->stiffness[e] == (x < 0.01 ? 1 : x < 0.02 ? 5 : 0.2));
    }
  }
}

TEST_CASE("inclusions: a scene without any tells the mesh nothing, one beside the mesh is an error") {
  TetMesh mesh = bar();
  put_inclusions(bar_with({}), mesh);
  CHECK(mesh.stiffness.empty());
  CHECK_THROWS_WITH(
      put_inclusions(bar_with({between(0.05, 0.06, 1)}), mesh),
      "test:7: no tetrahedron of the mesh has its centroid in this box; is it in metres, and larger than "
      "they are?");
}

TEST_CASE("inclusions: what is stiffer weighs no more, and both ways to have forces agree on it") {
  const Scene scene = bar_with({between(0.01, 0.02, 8e4)});
  const TetMesh plain = bar();
  TetMesh mesh = plain;
  put_inclusions(scene, mesh);
  const Solid solid(mesh, *scene.material), without(plain, *scene.material);
  CHECK(solid.masses() == without.masses());
  std::vector<Vec3> weight(solid.rest().size(), Vec3::Zero()), usual = weight;
  solid.add_body_forces({0, -1e4, 0}, weight);
  without.add_body_forces({0, -1e4, 0}, usual);
  CHECK(weight == usual);
  CHECK(disagreement(mesh, *scene.material) < 1e-12);
  CHECK(ElasticTensors(mesh, *scene.material, {}).masses() ==
        ElasticTensors(plain, *scene.material, {}).masses());
}
