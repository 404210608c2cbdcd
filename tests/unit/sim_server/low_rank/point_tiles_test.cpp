#include "sim_server/low_rank/point_tiles.h"

#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::sim;

TEST_CASE("tiles: points of a plate are halved along its longer side") {
  std::vector<Vec3> plate;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 4; ++x) plate.emplace_back(0.009 * x, 0.01 * y, 0);
  }
  const PointTiles tiles = tiles_of(plate, 8);
  REQUIRE(tiles.begins == std::vector{0, 8, 16, 24, 32});
  // Cut at y = 0.035, into squares of 4 x 4 points whose longer side is again that along y.
  for (int k = 0; k < 32; ++k) CHECK(tiles.order[static_cast<std::size_t>(k)] / 8 == k / 8);
}

TEST_CASE("tiles: each point is in one of them, none of which is too large, or half as large as another") {
  test::Random random(3);
  std::vector<Vec3> points;
  for (int k = 0; k < 1001; ++k) points.push_back(random.vector(0.1));
  for (const int most : {1, 7, 128, 1001, 5000}) {
    CAPTURE(most);
    const PointTiles tiles = tiles_of(points, most);
    std::vector<int> sorted = tiles.order;
    std::ranges::sort(sorted);
    for (int k = 0; k < 1001; ++k) REQUIRE(sorted[static_cast<std::size_t>(k)] == k);
    CHECK(tiles.begins.front() == 0);
    CHECK(tiles.begins.back() == 1001);
    int smallest = 1001, largest = 0;
    for (std::size_t k = 0; k + 1 < tiles.begins.size(); ++k) {
      smallest = std::min(smallest, tiles.begins[k + 1] - tiles.begins[k]);
      largest = std::max(largest, tiles.begins[k + 1] - tiles.begins[k]);
    }
    CHECK(largest <= most);
    CHECK(2 * smallest >= largest);
  }
}

TEST_CASE("tiles: of no point there is none, and points at one place are told apart by their numbers") {
  CHECK(tiles_of({}, 8).begins == std::vector{0});
  const std::vector<Vec3> same(5, Vec3(1, 2, 3));
  CHECK(tiles_of(same, 2).order == std::vector{0, 1, 2, 3, 4});
}
