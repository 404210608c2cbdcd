#include "sim_server/mesh/refinement.h"

#include <algorithm>
#include <numeric>

#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/mesh_faults.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/mesh/surface.h"
#include "tests/support/catch.h"
#include "tests/support/cut_bodies.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

namespace palpate::sim {
namespace {

/// Cells of several sizes, with the vertices at y = 0 tagged "floor".
TetMesh uneven_block() {
  TetMesh mesh = grid_block({0, 0.01, 0.03}, {0, 0.02}, {0, 0.01, 0.015});
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].y() == 0) mesh.surface_tags["floor"].push_back(static_cast<int>(v));
  }
  return mesh;
}

/// 0.5 mm in a corner, growing away from there.
TetMesh in_a_corner() {
  return graded(uneven_block(), [](const Vec3& x) { return 0.0005 + 0.5 * x.norm(); });
}

}  // namespace

TEST_CASE("a refined mesh has eight tetrahedra for one, an eighth in size, in the same place") {
  const TetMesh coarse = uneven_block(), fine = refined(coarse);
  REQUIRE(fine.tetrahedra.size() == 8 * coarse.tetrahedra.size());
  for (std::size_t t = 0; t < fine.tetrahedra.size(); ++t) {
    const double entire = six_volumes(coarse, coarse.tetrahedra[t / 8]);
    CHECK(six_volumes(fine, fine.tetrahedra[t]) == Approx(entire / 8).epsilon(1e-12));
  }
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v) CHECK(fine.vertices[v] == coarse.vertices[v]);
  // Euler: one more vertex on each edge.
  CHECK(fine.vertices.size() == coarse.vertices.size() + static_cast<std::size_t>(describe(coarse).edges));
}

TEST_CASE("a refined mesh fits together: its surface is that of the coarse one, cut in four") {
  const TetMesh coarse = uneven_block(), fine = refined(refined(coarse));
  CHECK(boundary_surface(fine).triangles.size() == 16 * boundary_surface(coarse).triangles.size());
  CHECK(describe(fine).volume == Approx(0.03 * 0.02 * 0.015).epsilon(1e-12));
}

TEST_CASE("a refined mesh keeps its quality") {
  const TetMesh coarse = uneven_block();
  const double once = describe(refined(coarse)).min_dihedral;
  CHECK(describe(refined(refined(refined(coarse)))).min_dihedral > 0.99 * once);
}

TEST_CASE("what is tagged stays tagged, and no more") {
  for (const TetMesh& fine : {refined(uneven_block()), halved(halved(uneven_block())), in_a_corner()}) {
    for (std::size_t v = 0; v < fine.vertices.size(); ++v) {
      const auto& floor = fine.surface_tags.at("floor");
      const bool tagged = std::ranges::find(floor, static_cast<int>(v)) != floor.end();
      CHECK(tagged == (fine.vertices[v].y() == 0));
    }
  }
}

TEST_CASE("a middle between two tagged vertices is not tagged where no tagged triangle has the edge") {
  TetMesh coarse =
      palpate::test::corner_block(Vec3(1, 1, 1), {1, 1, 1});  // every vertex on both ends, or one
  for (const Triangle& triangle : palpate::test::by_mesh_vertices(boundary_surface(coarse))) {
    const auto at = [&](double x) {
      return std::ranges::all_of(triangle, [&](int v) { return coarse.vertices[v].x() == x; });
    };
    if (!at(0) && !at(1)) continue;
    coarse.tagged_triangles["ends"].push_back(triangle);
    for (const int v : triangle) coarse.surface_tags["ends"].push_back(v);
  }
  sort_tags(coarse);
  REQUIRE(coarse.surface_tags.at("ends").size() == coarse.vertices.size());
  for (const TetMesh& fine : {refined(coarse), halved(halved(coarse))}) {
    const auto& ends = fine.surface_tags.at("ends");
    for (std::size_t v = 0; v < fine.vertices.size(); ++v) {
      const double x = fine.vertices[v].x();
      CHECK(std::ranges::binary_search(ends, static_cast<int>(v)) == (x == 0 || x == 1));
    }
  }
}

TEST_CASE("of an irregular mesh too, all parts fit together, and each is as stiff as what it was cut from") {
  TetMesh liver = read_mesh(test::source_dir() + "/configs/meshes/liver_paper.msh");
  const double volume = describe(liver).volume;
  for (const Tetrahedron& t : liver.tetrahedra)
    liver.stiffness.push_back(liver.vertices[t[0]].x() > 0 ? 2 : 1);
  const auto moment = [](const TetMesh& mesh) {  // volume times stiffness
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
      sum += mesh.stiffness[t] * six_volumes(mesh, mesh.tetrahedra[t]) / 6;
    return sum;
  };
  const Vec3 place = liver.vertices[100];
  TetMesh near = graded(liver, [&](const Vec3& x) { return 0.003 + 0.7 * (x - place).norm(); });
  TetMesh half = halved(liver);
  CHECK(near.tetrahedra.size() < half.tetrahedra.size());
  for (TetMesh* mesh : {&near, &half}) {
    CHECK(moment(*mesh) == Approx(moment(liver)).epsilon(1e-12));
    CHECK(describe(*mesh).volume == Approx(volume).epsilon(1e-12));
    CHECK(describe(*mesh).min_dihedral > 0.25 * describe(liver).min_dihedral);
    CHECK(mend(*mesh).found.empty());
  }
}

TEST_CASE("a halved mesh fills the same place, fits together, and is between the mesh and a refined one") {
  const TetMesh coarse = uneven_block(), fine = halved(coarse), twice = halved(fine), near = in_a_corner();
  CHECK(fine.tetrahedra.size() >= 2 * coarse.tetrahedra.size());
  CHECK(fine.tetrahedra.size() < 8 * coarse.tetrahedra.size());
  for (const TetMesh* mesh : {&fine, &twice, &near}) {
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

TEST_CASE("a graded mesh is as fine as asked where asked, not everywhere, and keeps its quality") {
  const TetMesh mesh = in_a_corner();
  double largest = 0;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    Vec3 centre = Vec3::Zero();
    for (const int v : t) centre += mesh.vertices[v] / 4;
    double longest = 0;
    for (const auto& [a, b] : kEdges)
      longest = std::max(longest, (mesh.vertices[t[b]] - mesh.vertices[t[a]]).norm());
    CHECK(longest <= 0.0005 + 0.5 * centre.norm());
    largest = std::max(largest, longest);
  }
  CHECK(largest > 0.008);
  CHECK(describe(mesh).min_dihedral > 0.3 * describe(uneven_block()).min_dihedral);
}

}  // namespace palpate::sim
