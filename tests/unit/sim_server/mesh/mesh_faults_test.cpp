#include "sim_server/mesh/mesh_faults.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "common/error.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/catch.h"

namespace palpate::sim {
namespace {

TetMesh corner_tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}};
}

/// Six tetrahedra, vertices x fastest.
TetMesh cube() {
  return grid_block({0, 1}, {0, 1}, {0, 1});
}

void append(TetMesh& mesh, const TetMesh& other, const Vec3& shift = Vec3::Zero()) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Vec3& x : other.vertices) mesh.vertices.push_back(x + shift);
  for (const Tetrahedron& t : other.tetrahedra) {
    mesh.tetrahedra.push_back({first + t[0], first + t[1], first + t[2], first + t[3]});
  }
}

/// Why `mesh` is refused; empty where it is not.
std::string error_of(TetMesh mesh) {
  try {
    require_usable(mend(mesh), "F");
  } catch (const Error& error) {
    CHECK(error.exit_code() == 2);
    return error.what();
  }
  return "";
}

/// The first of two faults of `mesh`; the second is the hinge that it makes.
MeshFault fault_with_hinge(TetMesh& mesh, const std::string& hinge) {
  const MeshFaults faults = mend(mesh);
  REQUIRE(faults.found.size() == 2);
  CHECK(faults.found[1].cure == Cure::kAccepted);
  CHECK(faults.found[1].kind == "hinges");
  CHECK(faults.found[1].count == 1);
  CHECK(faults.found[1].example == hinge);
  return faults.found.front();
}

/// The only fault of `mesh`, which becomes what was made of it.
MeshFault only_fault(TetMesh& mesh) {
  const MeshFaults faults = mend(mesh);

  REQUIRE(faults.found.size() == 1);
  return faults.found.front();
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_CASE("a mesh that is in order is left as it is", "[mesh]") {
  TetMesh mesh = cube();
  mesh.surface_tags["base"] = {0, 1, 2, 3};
  const TetMesh before = mesh;
  const MeshFaults faults = mend(mesh);
  CHECK(faults.found.empty());
  CHECK(faults.surface_seen);
  CHECK(mesh.vertices == before.vertices);
  CHECK(mesh.tetrahedra == before.tetrahedra);
  CHECK(mesh.surface_tags == before.surface_tags);
  CHECK(mended_in_short(faults).empty());
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
  SECTION("so large that its volume overflows") {
    for (Vec3& x : mesh.vertices) x *= 1e200;
    CHECK(has(error_of(mesh), "is flat"));
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
    CHECK(has(error_of(mesh), "but the vertices are 0 to 3"));
  }
  SECTION("repeated vertex") {
    mesh.tetrahedra.push_back({0, 1, 3, 3});
    CHECK(error_of(mesh) == "F: tetrahedron 1 names vertex 3 twice; remove it or re-mesh");
  }
}

TEST_CASE("all vertices in one place: flat, and not to be merged", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  for (Vec3& x : mesh.vertices) x.setZero();
  CHECK(has(error_of(mesh), "is flat"));
  CHECK(has(error_of(mesh), "(the first of 2 kinds of faults: `sim_server mesh info` lists all)"));
}

TEST_CASE("an unused vertex is dropped, wherever it is, and tags follow", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  mesh.vertices.insert(mesh.vertices.begin() + 1, {Vec3(7, 8, 9), Vec3(nan, 0, 0)});
  mesh.tetrahedra = {{0, 3, 4, 5}};
  mesh.surface_tags = {{"base", {0, 1, 3, 4}}, {"nothing", {1, 2}}};
  const MeshFault fault = only_fault(mesh);
  CHECK(fault.cure == Cure::kMended);
  CHECK(fault.count == 2);
  CHECK(fault.example == "vertex 1 of all, at (7, 8, 9), belongs to no tetrahedron");
  CHECK(mesh.vertices == corner_tetrahedron().vertices);
  CHECK(mesh.tetrahedra == corner_tetrahedron().tetrahedra);
  CHECK(mesh.surface_tags == std::map<std::string, std::vector<int>>{{"base", {0, 1, 2}}});
}

TEST_CASE("a repeated tetrahedron is dropped, in whatever order it names its vertices", "[mesh]") {
  TetMesh mesh = cube();
  const std::vector<Tetrahedron> before = mesh.tetrahedra;
  const auto [a, b, c, d] = before[2];
  mesh.tetrahedra.insert(mesh.tetrahedra.begin() + 4, {b, c, a, d});
  mesh.tetrahedra.push_back({c, d, a, b});
  const MeshFaults faults = mend(mesh);
  REQUIRE(faults.found.size() == 1);
  CHECK(faults.found[0].count == 2);
  CHECK(has(faults.found[0].example, "is tetrahedron 2 again"));
  CHECK(mesh.tetrahedra == before);
  CHECK(mended_in_short(faults) == "repeated tetrahedra (2) dropped");
}

TEST_CASE("a mesh that lists all its tetrahedra the other way round is turned round", "[mesh]") {
  TetMesh mesh = grid_block({0, 1, 2}, {0, 1}, {0, 1});
  const TetMesh right = mesh;
  for (Tetrahedron& t : mesh.tetrahedra) std::swap(t[2], t[3]);
  const MeshFaults faults = mend(mesh);
  REQUIRE(faults.found.size() == 1);
  CHECK(faults.found[0].cure == Cure::kMended);
  CHECK(faults.found[0].count == right.tetrahedra.size());
  CHECK(faults.found[0].kind == "tetrahedra the other way round");
  CHECK(mesh.tetrahedra == right.tetrahedra);
  std::swap(mesh.tetrahedra[0][2], mesh.tetrahedra[0][3]);  // one alone is a slip
  CHECK(mend(mesh).refused());
}

TEST_CASE("a tetrahedron and its mirror image are not the same: one is inverted", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  mesh.tetrahedra.push_back({1, 0, 2, 3});
  CHECK(has(error_of(mesh), "F: tetrahedron 1 (vertices 1 0 2 3) is inverted"));
}

TEST_CASE("bodies that share faces vertex by vertex are joined", "[mesh]") {
  TetMesh mesh = cube();
  append(mesh, cube(), {1, 0, 0});
  mesh.surface_tags["both"] = {1, 8, 9};  // 1 and 8 are both at (1, 0, 0)
  SECTION("to the last bit") {}
  SECTION("but for rounding") {
    for (int v = 8; v < 16; ++v) mesh.vertices[v] += Vec3(1e-10, -1e-10, 1e-10);
  }
  const MeshFault fault = only_fault(mesh);
  CHECK(fault.cure == Cure::kMended);
  CHECK(fault.count == 4);
  CHECK(has(fault.example, "vertices 1 and 8 are both at (1, 0, 0)"));
  const TetMesh entire = grid_block({0, 1, 2}, {0, 1}, {0, 1});
  CHECK(mesh.vertices.size() == 12);
  CHECK(mesh.tetrahedra.size() == 12);
  const MeshInfo info = describe(mesh), expected = describe(entire);
  CHECK(info.edges == expected.edges);
  CHECK(info.boundary_triangles == 20);  // two on each unit square of the skin
  CHECK(info.volume == Approx(2));
  CHECK(mesh.surface_tags.at("both") == std::vector<int>{1, 8});  // (1, 0, 0), and (2, 0, 0): the ninth kept
}

TEST_CASE("the surface is looked at after bodies were joined", "[mesh]") {
  TetMesh mesh = cube();
  append(mesh, cube(), {1, 0, 0});
  mesh.vertices.insert(mesh.vertices.end(), {Vec3(3, 1, 0.5), Vec3(2.5, 2, 0.5)});
  mesh.tetrahedra.push_back({11, 15, 16, 17});  // on the edge from (2, 1, 0) to (2, 1, 1)
  const MeshFaults faults = mend(mesh);
  REQUIRE(faults.found.size() == 3);
  CHECK(faults.found[0].remedy == "merged");
  CHECK(faults.found[1].cure == Cure::kAccepted);
  CHECK(faults.found[1].example == "the surface meets itself along the edge from (2, 1, 0) to (2, 1, 1)");
  CHECK(faults.found[2].kind == "hinges");
}

TEST_CASE("tetrahedra each with vertices of their own become one body", "[mesh]") {
  const TetMesh block = grid_block({0, 1, 2, 3}, {0, 1, 2}, {0, 1});
  TetMesh soup;
  for (const Tetrahedron& t : block.tetrahedra) {
    const int n = static_cast<int>(soup.vertices.size());
    for (const int v : t) soup.vertices.push_back(block.vertices[v]);
    soup.tetrahedra.push_back({n, n + 1, n + 2, n + 3});
  }
  CHECK(only_fault(soup).count == 4 * 36 - 24);
  CHECK(soup.vertices.size() == 24);
  CHECK(describe(soup).boundary_triangles == describe(block).boundary_triangles);
}

TEST_CASE("bodies farther apart than rounding are two, and refused with their sizes", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  append(mesh, cube(), {5, 0, 0});
  CHECK(error_of(mesh) ==
        "F: 2 bodies that share no vertex, of 6, 1 tetrahedra, but the organ is one body; join them, or keep "
        "one (in Gmsh, save one physical volume)");
  TetMesh apart = cube();
  append(apart, cube(), {1 + 1e-6, 0, 0});  // 4e-7 of the diagonal
  CHECK(has(error_of(apart), "2 bodies that share no vertex, of 6, 6 tetrahedra"));
  for (int i = 2; i < 22; ++i) append(mesh, corner_tetrahedron(), Vec3(5. * i, 0, 0));
  CHECK(has(error_of(mesh), "F: 22 bodies that share no vertex, of 6, 1, 1,"));
  CHECK(has(error_of(mesh), ", 1, ... tetrahedra"));
}

TEST_CASE("vertices in one place are not merged where that is not plain", "[mesh]") {
  TetMesh mesh = cube();
  SECTION("it would flatten a tetrahedron") {
    mesh.vertices[1] = mesh.vertices[0] + Vec3(1e-10, 0, 0);
    CHECK(has(error_of(mesh), "vertices 0 and 1 are both at (0, 0, 0), and merging them would flatten"));
  }
  SECTION("two cubes that touch along an edge") {
    append(mesh, cube(), {1, 1, 0});
    CHECK(
        has(error_of(mesh), "F: vertices 3 and 8 are both at (1, 1, 0), but cannot be merged: bodies that"));
  }
  SECTION("two cubes that touch at a corner") {
    append(mesh, cube(), {1, 1, 1});
    CHECK(has(error_of(mesh), "would hang by an edge or a vertex"));
  }
  SECTION("faces cut along the other diagonal") {
    TetMesh turned = cube();  // by a quarter about x: (x, y, z) -> (x, -z, y)
    for (Vec3& x : turned.vertices) x = Vec3(x[0], 1 - x[2], x[1]);
    append(mesh, turned, {1, 0, 0});
    CHECK(has(error_of(mesh), "do not share whole faces"));
  }
  SECTION("a body twice") {
    append(mesh, cube());
    CHECK(has(error_of(mesh), "two tetrahedra lie in one place"));
  }
  SECTION("bodies that overlap") {  // both on the same side of the face 0 1 2
    mesh = corner_tetrahedron();
    TetMesh other = corner_tetrahedron();
    other.vertices[3] = {0.2, 0.2, 0.7};
    append(mesh, other);
    CHECK(has(error_of(mesh),
              "vertices 0 and 4 are both at (0, 0, 0), but cannot be merged: bodies overlap there"));
    CHECK(has(error_of(mesh), "the first of 3 vertices where there is one already; cut one of them away"));
  }
}

TEST_CASE("the sides of a slit are not merged", "[mesh]") {
  // 2 x 2 cells around the line x = y = 1; between the two cells of y < 1 the vertices stand twice.
  TetMesh mesh = grid_block({0, 1, 2}, {0, 1, 2}, {0, 1});
  const auto n = static_cast<int>(mesh.vertices.size());
  for (const int v : {1, 10}) mesh.vertices.push_back(mesh.vertices[v]);  // (1, 0, 0), (1, 0, 1)
  for (Tetrahedron& t : mesh.tetrahedra) {
    double x = 0;
    for (const int v : t) x += mesh.vertices[v][0] / 4;
    for (int& v : t) {
      if (x > 1 && (v == 1 || v == 10)) v = v == 1 ? n : n + 1;
    }
  }
  CHECK(
      error_of(mesh) ==
      "F: vertices 1 and 18 are both at (1, 0, 0), in one body: a seam, or the sides of a slit, the first of "
      "2 vertices where there is one already; merge them if it is a seam (`Coherence Mesh;` in Gmsh); move "
      "them more than 7.2e-07 m apart if it is a slit");
}

TEST_CASE("bodies that were written in single precision are joined", "[mesh]") {
  TetMesh mesh = cube();
  append(mesh, cube(), {1 + 2e-7, 0, 1e-7});
  CHECK(mend(mesh).found.front().cure == Cure::kMended);
  CHECK(mesh.vertices.size() == 12);
}

/// A cube beside one of eight cells, joined where their vertices are in one place.
TetMesh half_fine() {
  TetMesh mesh = cube();
  const TetMesh fine = grid_block({1, 1.5, 2}, {0, 0.5, 1}, {0, 0.5, 1});
  std::vector<int> number;
  for (const Vec3& x : fine.vertices) {
    const auto same = std::ranges::find(mesh.vertices, x);
    number.push_back(static_cast<int>(same - mesh.vertices.begin()));
    if (same == mesh.vertices.end()) mesh.vertices.push_back(x);
  }
  for (const Tetrahedron& t : fine.tetrahedra)
    mesh.tetrahedra.push_back({number[t[0]], number[t[1]], number[t[2]], number[t[3]]});
  return mesh;
}

TEST_CASE("faces that lie on others without matching them are a crack, with its area", "[mesh]") {
  const std::string error = error_of(half_fine());
  CHECK(has(error, "1e+06 mm2 of the surface lie on other surface, as at (1, "));
  CHECK(has(error, "BooleanFragments"));
}

TEST_CASE("sides of a slit that stand apart, and those of a thin sheet, are no crack", "[mesh]") {
  TetMesh mesh = half_fine();
  for (Vec3& x : mesh.vertices) {
    // Beyond the seam, all but what both sides share goes 1e-4 of an edge away.
    const bool shared = (x[1] == 0 || x[1] == 1) && (x[2] == 0 || x[2] == 1);
    if (x[0] == 1 && !shared) x[0] += 1e-4;
  }
  CHECK_FALSE(has(error_of(mesh), "crack"));
  CHECK(error_of(grid_block({0, 1, 2}, {0, 1e-5}, {0, 1, 2})).empty());
}

TEST_CASE("tetrahedra that overlap at a face are refused", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  mesh.vertices.emplace_back(0.2, 0.2, 0.7);
  mesh.tetrahedra.push_back({0, 1, 2, 4});
  CHECK(error_of(mesh) ==
        "F: the face of vertices [0, 1, 2] belongs to 2 tetrahedra (0, 1), but a solid has one on each side "
        "of a "
        "face; remove the tetrahedra that overlap");
}

TEST_CASE("a surface that meets itself is accepted, and told", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  SECTION("along an edge") {
    mesh.vertices.insert(mesh.vertices.end(), {Vec3(0, -1, 0), Vec3(0, 0, -1)});
    mesh.tetrahedra.push_back({0, 1, 4, 5});
    const MeshFault fault = fault_with_hinge(
        mesh, "parts of 1 and 1 tetrahedra are joined by vertices 0 1 alone, at (0, 0, 0) to (1, 0, 0)");
    CHECK(fault.cure == Cure::kAccepted);
    CHECK(fault.count == 1);
    CHECK(fault.kind == "edges on more than two triangles");
    CHECK(fault.example == "the surface meets itself along the edge from (0, 0, 0) to (1, 0, 0)");
  }
  SECTION("at a vertex") {
    mesh.vertices.insert(mesh.vertices.end(), {Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)});
    mesh.tetrahedra.push_back({0, 4, 6, 5});
    const MeshFault fault =
        fault_with_hinge(mesh, "parts of 1 and 1 tetrahedra are joined by vertex 0 alone, at (0, 0, 0)");
    CHECK(fault.cure == Cure::kAccepted);
    CHECK(fault.count == 1);
    CHECK(fault.example == "the surface meets itself at (0, 0, 0)");
  }
}

TEST_CASE("a sliver is told of below a dihedral angle of one degree, with what it does", "[mesh]") {
  TetMesh mesh = corner_tetrahedron();
  const auto apex_at = [&](double degrees) {  // the slanted face stands on the line x + y = 1
    mesh.vertices.back()[2] = std::tan(degrees * std::numbers::pi / 180) * std::sqrt(0.5);
  };
  apex_at(1.01);
  CHECK(mend(mesh).found.empty());
  apex_at(0.5);
  const MeshFault fault = only_fault(mesh);
  CHECK(fault.cure == Cure::kAccepted);
  CHECK(fault.count == 1);
  CHECK(fault.kind == "slivers");
  CHECK(has(fault.example,
            "tetrahedron 0 (vertices 0 1 2 3) at (0, 0, 0) has a dihedral angle of 0.5 degrees, below 1;"));
  CHECK(has(fault.example, "the shortest height of all is 6.2 mm"));  // sqrt(1/2) tan(0.5 degrees) m
  CHECK(has(fault.remedy, "-optimize_netgen"));
}

TEST_CASE("all that is wrong is told at once", "[mesh]") {
  TetMesh mesh = cube();
  append(mesh, corner_tetrahedron(), {5, 0, 0});            // a second body
  std::swap(mesh.tetrahedra[1][0], mesh.tetrahedra[1][1]);  // inverted
  std::swap(mesh.tetrahedra[3][0], mesh.tetrahedra[3][1]);
  mesh.tetrahedra.push_back(mesh.tetrahedra[0]);  // repeated
  mesh.vertices.emplace_back(9, 9, 9);            // unused
  const MeshFaults faults = mend(mesh);
  std::vector<std::string> kinds;
  for (const MeshFault& f : faults.found) kinds.push_back(std::to_string(f.count) + " " + f.kind);
  CHECK(kinds == std::vector<std::string>{"1 unused vertices", "1 repeated tetrahedra",
                                          "2 inverted tetrahedra", "2 bodies"});
  CHECK(faults.surface_seen);  // inverted ones are turned round for that, else their faces would overlap
  CHECK(mended_in_short(faults) == "unused vertices (1) dropped, repeated tetrahedra (1) dropped");
  CHECK(has(error_of(mesh),
            ", the first of 2 inverted tetrahedra; swap two of its vertices (the first of 2 kinds"));
}

TEST_CASE("with a flat tetrahedron, the surface and what could be merged are left for later", "[mesh]") {
  TetMesh mesh = cube();
  append(mesh, cube(), {1, 0, 0});
  append(mesh, corner_tetrahedron(), {5, 0, 0});
  mesh.vertices.back() = {5.2, 0.2, 0};
  const MeshFaults faults = mend(mesh);
  CHECK_FALSE(faults.surface_seen);
  REQUIRE(faults.found.size() == 3);
  CHECK(faults.found[0].kind == "flat tetrahedra");
  CHECK(faults.found[1].cure == Cure::kRefused);
  CHECK(has(faults.found[1].remedy, "once no tetrahedron is flat or inverted"));
  CHECK(faults.found[2].kind == "bodies");
  CHECK(mesh.vertices.size() == 20);
}

}  // namespace
}  // namespace palpate::sim
