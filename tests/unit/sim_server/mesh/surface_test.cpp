#include "sim_server/mesh/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <string>

#include "common/error.h"
#include "tests/support/catch.h"

namespace palpate::sim {
namespace {

TetMesh two_tetrahedra() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}, {}};
}

// The unit cube in `n`^3 cells of six tetrahedra along the main diagonal of each.
TetMesh cube(int n) {
  TetMesh mesh;
  const auto vertex = [n](const Triangle& at) { return (at[0] * (n + 1) + at[1]) * (n + 1) + at[2]; };
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      for (int k = 0; k <= n; ++k) mesh.vertices.emplace_back(Vec3(i, j, k) / n);
    }
  }
  for (int cell = 0; cell < n * n * n; ++cell) {
    Triangle order{0, 1, 2};
    do {
      Triangle corner{cell / (n * n), cell / n % n, cell % n};
      Tetrahedron t{vertex(corner), 0, 0, 0};
      for (int step = 0; step < 3; ++step) {
        ++corner[order[step]];
        t[step + 1] = vertex(corner);
      }
      if (six_volumes(mesh, t) < 0) std::swap(t[1], t[2]);
      mesh.tetrahedra.push_back(t);
    } while (std::next_permutation(order.begin(), order.end()));
  }
  return mesh;
}

Vec3 at(const TetMesh& mesh, const Surface& surface, int vertex) {
  return mesh.vertices[surface.vertices[vertex]];
}

Vec3 area_of(const TetMesh& mesh, const Surface& surface, const Triangle& t) {
  const Vec3 a = at(mesh, surface, t[0]);
  return 0.5 * (at(mesh, surface, t[1]) - a).cross(at(mesh, surface, t[2]) - a);
}

// Every directed edge once, and its opposite too.
void check_closed(const Surface& surface) {
  std::set<std::pair<int, int>> edges;
  for (const Triangle& t : surface.triangles) {
    for (int i = 0; i < 3; ++i) CHECK(edges.emplace(t[i], t[(i + 1) % 3]).second);
  }
  for (const auto& edge : edges) CHECK(edges.count({edge.second, edge.first}) == 1);
}

// By the divergence theorem: positive when the triangles look outward.
double enclosed_volume(const TetMesh& mesh, const Surface& surface) {
  double six_v = 0;
  for (const Triangle& t : surface.triangles) {
    const auto x = [&](int corner) { return mesh.vertices[surface.vertices[t[corner]]]; };
    six_v += x(0).dot(x(1).cross(x(2)));
  }
  return six_v / 6;
}

TEST_CASE("a tetrahedron is all surface", "[mesh]") {
  const TetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}};
  const Surface surface = boundary_surface(mesh);
  CHECK(surface.vertices == std::vector<int>{0, 1, 2, 3});
  REQUIRE(surface.triangles.size() == 4);
  const Vec3 centre = Vec3::Constant(0.25);
  for (const Triangle& t : surface.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    CHECK((b - a).cross(c - a).dot(a - centre) > 0);
  }
}

TEST_CASE("the face between two tetrahedra is inside", "[mesh]") {
  const Surface surface = boundary_surface(two_tetrahedra());
  CHECK(surface.triangles.size() == 6);
  for (Triangle t : surface.triangles) {
    std::ranges::sort(t);
    CHECK(t != Triangle{1, 2, 3});
  }
}

TEST_CASE("the surface of a cube is closed, outward and numbered without the vertices inside", "[mesh]") {
  const int n = GENERATE(1, 2, 3);
  const TetMesh mesh = cube(n);
  const Surface surface = boundary_surface(mesh);
  CHECK(surface.triangles.size() == static_cast<std::size_t>(12 * n * n));
  CHECK(surface.vertices.size() ==
        static_cast<std::size_t>((n + 1) * (n + 1) * (n + 1) - (n - 1) * (n - 1) * (n - 1)));
  CHECK(std::ranges::is_sorted(surface.vertices));
  CHECK(std::abs(enclosed_volume(mesh, surface) - 1) < 1e-12);
  check_closed(surface);
}

TEST_CASE("vertices in the middle of edges come last, one for each edge", "[mesh]") {
  const int n = GENERATE(1, 2, 3);
  const TetMesh plain = cube(n);
  TetMesh mesh = plain;
  add_mid_edges(mesh);
  // Euler: vertices - edges + faces - tetrahedra = 1, of 6 n^3 tetrahedra and 12 n^2 triangles outside.
  const int corners = (n + 1) * (n + 1) * (n + 1), faces = 12 * n * n * n + 6 * n * n;
  const int edges = corners + faces - 6 * n * n * n - 1;
  CHECK(mesh.corners() == corners);
  REQUIRE(mesh.mid_edges.size() == static_cast<std::size_t>(edges));
  REQUIRE(mesh.vertices.size() == static_cast<std::size_t>(corners + edges));
  CHECK(mesh.tetrahedra == plain.tetrahedra);
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const auto& [i, j] : kEdges) {
      const int middle = mesh.middle(t[i], t[j]);
      CHECK(mesh.middle(t[j], t[i]) == middle);
      REQUIRE(middle >= corners);
      CHECK(mesh.vertices[middle] == 0.5 * (mesh.vertices[t[i]] + mesh.vertices[t[j]]));
    }
  }
  TetMesh again = mesh;
  add_mid_edges(again);
  CHECK(again.vertices == mesh.vertices);
  const MeshInfo info = describe(mesh), before = describe(plain);
  CHECK(info.vertices == corners);
  CHECK(info.edges == edges);
  CHECK(info.boundary_vertices == before.boundary_vertices);
  CHECK(info.boundary_triangles == 12 * n * n);
}

TEST_CASE("where edges have a vertex in the middle, each face of the surface is four triangles", "[mesh]") {
  const int n = GENERATE(1, 2, 3);
  TetMesh mesh = cube(n);
  const Surface plain = boundary_surface(mesh);
  add_mid_edges(mesh);
  const Surface surface = boundary_surface(mesh);
  CHECK(plain.per_face == 1);
  REQUIRE(surface.per_face == 4);
  REQUIRE(surface.triangles.size() == 4 * plain.triangles.size());
  // Euler, of a closed surface without handles: vertices - triangles / 2 = 2.
  CHECK(surface.vertices.size() == static_cast<std::size_t>(24 * n * n + 2));
  CHECK(std::ranges::is_sorted(surface.vertices));
  check_closed(surface);
  CHECK(std::abs(enclosed_volume(mesh, surface) - 1) < 1e-12);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const Vec3 entire = area_of(mesh, plain, plain.triangles[i / 4]);
    CHECK((area_of(mesh, surface, surface.triangles[i]) - entire / 4).norm() < 1e-15);
    const std::size_t part = i % 4;
    const int first = surface.vertices[surface.triangles[i][0]];
    if (part < 3) CHECK(first == plain.vertices[plain.triangles[i / 4][part]]);
    if (part == 3) CHECK(first >= mesh.corners());
  }
}

TEST_CASE("the surface does not depend on the run", "[mesh]") {
  const TetMesh mesh = cube(3);
  CHECK(boundary_surface(mesh).triangles == boundary_surface(mesh).triangles);
}

TEST_CASE("a face of three tetrahedra is an error that names them", "[mesh]") {
  TetMesh mesh = two_tetrahedra();
  mesh.vertices.emplace_back(2, 2, 2);
  mesh.tetrahedra.push_back({1, 2, 3, 5});
  std::string message;
  try {
    boundary_surface(mesh);
  } catch (const Error& error) {
    message = error.what();
  }
  CHECK(message ==
        "mesh: the face of vertices [1, 2, 3] belongs to 3 tetrahedra (0, 1, 2), but a solid has one on each "
        "side "
        "of a face; remove the tetrahedra that overlap");
}

}  // namespace
TEST_CASE("two tetrahedra on the same side of a face overlap, and are refused") {
  palpate::sim::TetMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1, 0.1, 2}};
  mesh.tetrahedra = {{0, 1, 2, 3}, {0, 1, 2, 4}};
  CHECK_THROWS_AS(palpate::sim::boundary_surface(mesh), palpate::Error);
}

}  // namespace palpate::sim
