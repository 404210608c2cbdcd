#include "sim_server/study/surface_sites.h"

#include "sim_server/mesh/shapes.h"
#include "tests/support/catch.h"

namespace palpate::sim {

TEST_CASE("sites follow an even motion of the surface exactly, wherever its corners are") {
  const TetMesh mesh = grid_block({0, 0.3, 1}, {0, 0.5, 1}, {0, 1});
  const Surface surface = boundary_surface(mesh);
  std::vector<Vec3> rest, now;
  const Mat3 gradient = (Mat3() << 0.1, 0.2, 0, -0.1, 0.05, 0.3, 0, 0.1, -0.2).finished();
  for (const int v : surface.vertices) {
    rest.push_back(mesh.vertices[v]);
    now.push_back(rest.back() + gradient * rest.back() + Vec3(1, 2, 3));
  }
  const std::vector<Vec3> sites{{0.2, 0, 0.7}, {1, 0.9, 0.1}, {0.3, 0.5, 1}, {0.77, 1, 0.2}};
  const SurfaceSites followed(rest, surface, sites);
  std::vector<Vec3> moved;
  followed.add(rest, now, moved);
  REQUIRE(moved.size() == sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k)
    CHECK((moved[k] - (gradient * sites[k] + Vec3(1, 2, 3))).norm() < 1e-12);
}

}  // namespace palpate::sim
