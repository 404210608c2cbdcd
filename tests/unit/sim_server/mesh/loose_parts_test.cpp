#include "sim_server/mesh/loose_parts.h"

#include "sim_server/mesh/shapes.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

using Hold = LoosePart::Hold;

/// Vertices of `mesh` for which `where` is true.
template <class Where>
std::vector<int> vertices(const TetMesh& mesh, const Where& where) {
  std::vector<int> all;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (where(mesh.vertices[v])) all.push_back(v);
  }
  return all;
}

/// A cube from 0 to 1, and one beside it that shares the edge x = 1, y = 1 alone.
TetMesh hinged_cubes() {
  TetMesh mesh = grid_block({0, 1}, {0, 1}, {0, 1}), other = grid_block({1, 2}, {1, 2}, {0, 1});
  std::vector<int> number;
  for (const Vec3& x : other.vertices) {
    const auto same = vertices(mesh, [&](const Vec3& y) { return x == y; });
    number.push_back(same.empty() ? static_cast<int>(mesh.vertices.size()) : same.front());
    if (same.empty()) mesh.vertices.push_back(x);
  }
  for (Tetrahedron t : other.tetrahedra) {
    for (int& v : t) v = number[v];
    mesh.tetrahedra.push_back(t);
  }
  return mesh;
}

}  // namespace

TEST_CASE("a body is loose until three of its vertices are held that are not in one line") {
  const TetMesh cube = grid_block({0, 1}, {0, 1}, {0, 1});
  const auto held_by = [&](const auto& where) { return loose_parts(cube, vertices(cube, where)); };
  const auto by_none = held_by([](const Vec3&) { return false; });
  REQUIRE(by_none.size() == 1);
  CHECK(by_none[0].tetrahedra == 6);
  CHECK(by_none[0].hold == Hold::kNone);
  const auto by_one = held_by([](const Vec3& x) { return x == Vec3(1, 0, 1); });
  REQUIRE(by_one.size() == 1);
  CHECK(by_one[0].hold == Hold::kPlace);
  CHECK(by_one[0].place == Vec3(1, 0, 1));
  const auto by_edge = held_by([](const Vec3& x) { return x[0] == 0 && x[1] == 0; });
  REQUIRE(by_edge.size() == 1);
  CHECK(by_edge[0].hold == Hold::kLine);
  CHECK(held_by([](const Vec3& x) { return x[0] == 0; }).empty());
  CHECK(held_by([](const Vec3& x) { return x.sum() == 1; }).empty());  // three corners
}

TEST_CASE("hinges are named by their vertices, parts that share three not in one line are one") {
  CHECK(hinges(grid_block({0, 1, 2}, {0, 1}, {0, 1})).empty());
  TetMesh mesh = hinged_cubes();
  const auto found = hinges(mesh);
  REQUIRE(found.size() == 1);
  CHECK(found[0].tetrahedra == std::array<std::size_t, 2>{6, 6});
  CHECK(found[0].vertices == vertices(mesh, [](const Vec3& x) { return x[0] == 1 && x[1] == 1; }));
  // A tetrahedron that bridges them: it meets each in an edge besides, so in three vertices not in one line.
  const auto at = [&](const Vec3& p) {
    return vertices(mesh, [&](const Vec3& x) { return x == p; }).front();
  };
  const std::array<int, 4> corners{at({1, 0, 0}), at({2, 1, 0}), at({1, 1, 0}), at({1, 1, 1})};
  mesh.tetrahedra.push_back(corners);
  CHECK(hinges(mesh).empty());
}

TEST_CASE("two bodies that meet in an edge are joined by a hinge, which holds no turn") {
  const TetMesh mesh = hinged_cubes();
  const auto remaining = vertices(mesh, [](const Vec3& x) { return x[0] == 0; });
  const auto loose = loose_parts(mesh, remaining);
  REQUIRE(loose.size() == 1);
  CHECK(loose[0].tetrahedra == 6);
  CHECK(loose[0].hold == Hold::kLine);
  CHECK(loose[0].place.head<2>() == Eigen::Vector2d(1, 1));
  CHECK(to_text(loose[0]).find("6 tetrahedra hang on a hinge at 1,1,") == 0);
  auto with_one_more = remaining;  // of the other
  with_one_more.push_back(vertices(mesh, [](const Vec3& x) { return x == Vec3(2, 2, 0); }).front());
  CHECK(loose_parts(mesh, with_one_more).empty());
}

TEST_CASE("loose parts that are dropped leave what is held, its stiffness, and all vertices") {
  TetMesh mesh = hinged_cubes();
  const TetMesh entire = mesh;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)  // as many times as far along x
    mesh.stiffness.push_back(1 + centre_of(mesh, mesh.tetrahedra[t])[0]);
  drop_loose_parts(mesh, vertices(mesh, [](const Vec3& x) { return x[0] == 2; }));
  CHECK(mesh.vertices == entire.vertices);
  REQUIRE(2 * mesh.tetrahedra.size() == entire.tetrahedra.size());
  REQUIRE(mesh.stiffness.size() == mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    CHECK(centre_of(mesh, mesh.tetrahedra[t])[0] > 1);  // the first cube hung on a hinge
    CHECK(mesh.stiffness[t] == 1 + centre_of(mesh, mesh.tetrahedra[t])[0]);
  }
  drop_loose_parts(mesh, {});
  CHECK(mesh.tetrahedra.empty());
}
