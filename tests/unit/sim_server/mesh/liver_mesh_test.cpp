#include <numbers>

#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/surface.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

using namespace palpate::sim;

TEST_CASE("the shipped liver has the size of the paper's: 1394 vertices, 8347 edges, 6342 tetrahedra") {
  const MeshInfo info = describe(read_mesh(palpate::test::source_dir() + "/configs/meshes/liver_paper.msh"));
  CHECK(info.vertices == Approx(1394).epsilon(0.03));
  CHECK(info.edges == Approx(8347).epsilon(0.03));
  CHECK(info.tetrahedra == Approx(6342).epsilon(0.03));
  CHECK(info.boundary_vertices == Approx(614).epsilon(0.03));
  CHECK(info.boundary_triangles == Approx(1224).epsilon(0.03));
  // Euler: a ball without voids.
  const int faces = (4 * info.tetrahedra + info.boundary_triangles) / 2;
  CHECK(info.vertices - info.edges + faces - info.tetrahedra == 1);
  CHECK(info.volume == Approx(1.5e-3).epsilon(0.1));
  CHECK((info.max - info.min).maxCoeff() == Approx(0.2).epsilon(0.15));
  CHECK(info.min_dihedral >= 10 * std::numbers::pi / 180);
}
