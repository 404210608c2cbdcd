#include "sim_server/scene/cutting.h"

#include <algorithm>

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

std::ptrdiff_t count(const std::vector<char>& all, char kind) {
  return std::ranges::count(all, kind);
}

}  // namespace

TEST_CASE("what can be cut: the tetrahedra whose centre is in a box, and near enough to the plan") {
  const TetMesh mesh = deep_block();
  const auto of_a_cell = static_cast<std::ptrdiff_t>(mesh.tetrahedra.size() / (8 * 4 * 8));
  Cutting cutting{.where = "test"};
  CHECK(count(removable_tetrahedra(cutting, mesh), 1) == 256 * of_a_cell);
  cutting.region = Region{.box = Box{Vec3(-1, -0.005, -1), Vec3(1, 1, 1)}};  // the top layer
  CHECK(count(removable_tetrahedra(cutting, mesh), 1) == 64 * of_a_cell);
  cutting.plan = CutPlan{.point = Vec3(0.005, 0, 0), .normal = Vec3::UnitX(), .within = 0.005};
  CHECK(count(removable_tetrahedra(cutting, mesh), 1) == 16 * of_a_cell);  // 2 of 8 rows
}

TEST_CASE("what can be cut: in a ball, or at a tagged part of the surface") {
  TetMesh mesh = deep_block();
  const Vec3 middle(0.001, -0.01, 0.002);
  Cutting cutting{.where = "test"};
  cutting.region = Region{.ball = Ball{middle, 0.012}};
  const std::vector<char> in_ball = removable_tetrahedra(cutting, mesh);
  for (std::size_t t = 0; t < in_ball.size(); ++t) {
    const bool inside = (centre_of(mesh, mesh.tetrahedra[t]) - middle).norm() <= 0.012;
    CHECK((in_ball[t] == 1) == inside);
  }
  CHECK(count(in_ball, 1) > 50);

  const auto corner = std::ranges::find_if(
      mesh.vertices, [](const Vec3& x) { return (x - Vec3(0.02, 0, 0.02)).norm() < 1e-9; });
  const auto vertex = static_cast<int>(corner - mesh.vertices.begin());
  mesh.surface_tags["corner"] = {vertex};
  cutting.region = Region{.surface_tag = "corner"};
  const std::vector<char> at_corner = removable_tetrahedra(cutting, mesh);
  for (std::size_t t = 0; t < at_corner.size(); ++t)
    CHECK((at_corner[t] == 1) == (std::ranges::count(mesh.tetrahedra[t], vertex) > 0));
  CHECK(count(at_corner, 1) > 0);
}

TEST_CASE("what can be cut: where there is nothing, an error says what to change") {
  Cutting cutting{.where = "scene.toml:7"};
  cutting.region = Region{.ball = Ball{Vec3(1, 1, 1), 0.01}};
  CHECK_THROWS_WITH(removable_tetrahedra(cutting, deep_block()),
                    Catch::Contains("scene.toml:7") && Catch::Contains("make the region"));
}
