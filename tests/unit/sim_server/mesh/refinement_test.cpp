#include "sim_server/mesh/refinement.h"

#include <algorithm>
#include <numeric>

#include "sim_server/mesh/mesh_faults.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/mesh/surface.h"
#include "tests/support/catch.h"

namespace palpate::sim {
namespace {

TetMesh block() {
  TetMesh mesh = grid_block({0, 0.01, 0.03}, {0, 0.02}, {0, 0.01, 0.015});
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].y() == 0) mesh.surface_tags["floor"].push_back(static_cast<int>(v));
  }
  return mesh;
}

}  // namespace

TEST_CASE("a refined mesh has eight tetrahedra for one, an eighth in size, in the same place") {
  const TetMesh coarse = block(), fine = refined(coarse);
  REQUIRE(fine.tetrahedra.size() == 8 * coarse.tetrahedra.size());
  for (std::size_t t = 0; t < fine.tetrahedra.size(); ++t) {
    const double whole = six_volumes(coarse, coarse.tetrahedra[t / 8]);
    CHECK(six_volumes(fine, fine.tetrahedra[t]) == Approx(whole / 8).epsilon(1e-12));
  }
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v) CHECK(fine.vertices[v] == coarse.vertices[v]);
  // Euler: one more vertex on each edge.
  CHECK(fine.vertices.size() == coarse.vertices.size() + static_cast<std::size_t>(describe(coarse).edges));
}

TEST_CASE("a refined mesh fits together: its surface is that of the coarse one, cut in four") {
  const TetMesh coarse = block(), fine = refined(refined(coarse));
  CHECK(boundary_surface(fine).triangles.size() == 16 * boundary_surface(coarse).triangles.size());
  CHECK(describe(fine).volume == Approx(0.03 * 0.02 * 0.015).epsilon(1e-12));
}

TEST_CASE("a refined mesh keeps its quality") {
  const TetMesh coarse = block();
  const double once = describe(refined(coarse)).min_dihedral;
  CHECK(describe(refined(refined(refined(coarse)))).min_dihedral > 0.99 * once);
}

TEST_CASE("what is tagged stays tagged, and no more") {
  const TetMesh fine = refined(block());
  for (std::size_t v = 0; v < fine.vertices.size(); ++v) {
    const auto& floor = fine.surface_tags.at("floor");
    const bool tagged = std::find(floor.begin(), floor.end(), static_cast<int>(v)) != floor.end();
    CHECK(tagged == (fine.vertices[v].y() == 0));
  }
}

TEST_CASE("a halved mesh fills the same place, fits together, and is between the mesh and a refined one") {
  const TetMesh coarse = block(), fine = halved(coarse), twice = halved(fine);
  CHECK(fine.tetrahedra.size() >= 2 * coarse.tetrahedra.size());
  CHECK(fine.tetrahedra.size() < 8 * coarse.tetrahedra.size());
  for (const TetMesh* mesh : {&fine, &twice}) {
    // A middle on one side only would open the surface there.
    TetMesh looked_at = *mesh;
    CHECK(mend(looked_at).found.empty());
    CHECK(describe(*mesh).volume == Approx(0.03 * 0.02 * 0.015).epsilon(1e-12));
    double area = 0;
    const Surface skin = boundary_surface(*mesh);
    for (const auto& [a, b, c] : skin.triangles)
      area += 0.5 * (mesh->vertices[skin.vertices[b]] - mesh->vertices[skin.vertices[a]])
                        .cross(mesh->vertices[skin.vertices[c]] - mesh->vertices[skin.vertices[a]])
                        .norm();
    CHECK(area == Approx(2 * (0.03 * 0.02 + 0.03 * 0.015 + 0.02 * 0.015)).epsilon(1e-12));
  }
}

}  // namespace palpate::sim
