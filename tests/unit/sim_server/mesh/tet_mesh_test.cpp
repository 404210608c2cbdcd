#include "sim_server/mesh/tet_mesh.h"

#include <cmath>
#include <limits>
#include <string>

#include "common/error.h"
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

void append(TetMesh& mesh, const TetMesh& other, const Vec3& shift) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Vec3& x : other.vertices) mesh.vertices.push_back(x + shift);
  for (const Tetrahedron& t : other.tetrahedra) {
    mesh.tetrahedra.push_back({first + t[0], first + t[1], first + t[2], first + t[3]});
  }
}

std::string error_of(const TetMesh& mesh) {
  try {
    validate(mesh, "F");
  } catch (const Error& error) {
    CHECK(error.exit_code() == 2);
    return error.what();
  }
  return "";
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

TEST_CASE("sound meshes are valid", "[mesh]") {
  CHECK(error_of(corner_tetrahedron()).empty());
  CHECK(error_of(unit_cube()).empty());
}

TEST_CASE("size does not make a tetrahedron flat", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  const double scale = GENERATE(1e-6, 1e-3, 1e3);
  for (Vec3& x : mesh.vertices) x *= scale;
  CHECK(error_of(mesh).empty());
}

TEST_CASE("what is wrong with a mesh is named", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  SECTION("no tetrahedra") {
    mesh.tetrahedra.clear();
    CHECK(error_of(mesh) ==
          "F: no tetrahedra (4 nodes, Gmsh element type 4); fill the surface first, as `gmsh -3 MODEL.geo` "
          "does");
  }
  SECTION("flat") {
    mesh.vertices[3] = {0.5, 0.5, 1e-14};
    CHECK(error_of(mesh) ==
          "F: tetrahedron 0 (vertices 0 1 2 3) is flat: volume 1.67e-15 m^3 at (0, 0, 0) (1, 0, 0) (0, 1, 0) "
          "(0.5, "
          "0.5, 1e-14); re-mesh, or move a vertex");
  }
  SECTION("all vertices in one place") {
    for (Vec3& x : mesh.vertices) x.setZero();
    CHECK(error_of(mesh).find("is flat") != std::string::npos);
  }
  SECTION("so large that its volume overflows") {
    for (Vec3& x : mesh.vertices) x *= 1e200;
    CHECK(error_of(mesh).find("is flat") != std::string::npos);
  }
  SECTION("inverted") {
    std::swap(mesh.tetrahedra[0][2], mesh.tetrahedra[0][3]);
    CHECK(error_of(mesh) ==
          "F: tetrahedron 0 (vertices 0 1 3 2) is inverted: volume -0.167 m^3 at (0, 0, 0) (1, 0, 0) (0, 0, "
          "1) (0, "
          "1, 0); swap two of its vertices");
  }
  SECTION("not a number") {
    mesh.vertices[2][1] = std::numeric_limits<double>::quiet_NaN();
    CHECK(error_of(mesh) ==
          "F: vertex 2 is at (0, nan, 0): every coordinate must be a finite number; export the mesh again");
  }
  SECTION("infinite") {
    mesh.vertices[2][1] = std::numeric_limits<double>::infinity();
    CHECK(error_of(mesh).find("F: vertex 2 is at (0, inf, 0)") == 0);
  }
  SECTION("missing vertex") {
    mesh.tetrahedra[0][1] = GENERATE(-1, 4);
    CHECK(error_of(mesh).find("but the vertices are 0 to 3") != std::string::npos);
  }
  SECTION("repeated vertex") {
    mesh.tetrahedra[0][1] = 3;
    CHECK(error_of(mesh) == "F: tetrahedron 0 names vertex 3 twice; remove it or re-mesh");
  }
  SECTION("unused vertex") {
    mesh.vertices.emplace_back(2, 2, 2);
    CHECK(error_of(mesh) == "F: vertex 4 belongs to no tetrahedron; remove it");
  }
}

TEST_CASE("a mesh of several bodies is an error that says how many and how large", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  append(mesh, unit_cube(), {5, 0, 0});
  CHECK(error_of(mesh) ==
        "F: 2 bodies that share no vertex, of 6, 1 tetrahedra, but the organ is one body; join them or keep "
        "one");
  for (int i = 2; i < 7; ++i) append(mesh, corner_tetrahedron(), Vec3(5. * i, 0, 0));
  CHECK(error_of(mesh).find("F: 7 bodies that share no vertex, of 6, 1, 1, 1, 1, ... tetrahedra") == 0);
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
