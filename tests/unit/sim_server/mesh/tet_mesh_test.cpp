#include "sim_server/mesh/tet_mesh.h"

#include <cmath>

#include "tests/support/catch.h"

namespace palpate::sim {
namespace {

TetMesh corner_tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}};
}

// Vertex 4a + 2b + c is at (a, b, c); every tetrahedron goes along the edges from one end of a diagonal to
// the other.
TetMesh unit_cube() {
  TetMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices.emplace_back(i / 4, i / 2 % 2, i % 2);
  mesh.tetrahedra = {{0, 4, 6, 7}, {0, 5, 4, 7}, {0, 6, 2, 7}, {0, 2, 3, 7}, {0, 1, 5, 7}, {0, 3, 1, 7}};
  return mesh;
}

bool near(double a, double b) {
  return std::abs(a - b) < 1e-12;
}

TEST_CASE("six_volumes is the determinant, with its sign", "[mesh]") {
  const TetMesh mesh = corner_tetrahedron();
  CHECK(near(six_volumes(mesh, {0, 1, 2, 3}), 1));
  CHECK(near(six_volumes(mesh, {0, 2, 1, 3}), -1));
  CHECK(near(six_volumes(mesh, {1, 2, 0, 3}), 1));
}

TEST_CASE("describe a unit cube of six tetrahedra", "[mesh]") {
  const MeshInfo info = describe(unit_cube());
  CHECK(info.vertices == 8);
  CHECK(info.edges == 19);
  CHECK(info.tetrahedra == 6);
  CHECK(info.boundary_vertices == 8);
  CHECK(info.boundary_triangles == 12);
  CHECK(near(info.volume, 1));
  CHECK(info.min == Vec3(0, 0, 0));
  CHECK(info.max == Vec3(1, 1, 1));
  CHECK(near(info.min_edge, 1));
  CHECK(near(info.median_edge, 1));  // 12 edges of the cube, 6 diagonals of faces, one of the cube
  CHECK(near(info.max_edge, std::sqrt(3)));
  // Around an edge of the cube: one quarter turn, or two halves of it; around its diagonal six sixths of a
  // turn.
  CHECK(near(info.min_dihedral, M_PI / 4));
  CHECK(near(info.median_min_dihedral, M_PI / 4));
  CHECK(near(info.max_dihedral, M_PI / 2));
}

TEST_CASE("describe a regular tetrahedron", "[mesh]") {
  const double edge = 0.01;
  TetMesh mesh{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 2, 1, 3}}, {}};
  for (Vec3& x : mesh.vertices) x *= edge / std::sqrt(8);
  if (six_volumes(mesh, mesh.tetrahedra[0]) < 0) std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
  const MeshInfo info = describe(mesh);
  CHECK(std::abs(info.volume - edge * edge * edge / std::sqrt(72)) < 1e-18);
  CHECK(near(info.min_edge, edge));
  CHECK(near(info.max_edge, edge));
  CHECK(near(info.min_dihedral, std::acos(1. / 3)));
  CHECK(near(info.median_min_dihedral, std::acos(1. / 3)));
  CHECK(near(info.max_dihedral, std::acos(1. / 3)));
}

}  // namespace
}  // namespace palpate::sim
