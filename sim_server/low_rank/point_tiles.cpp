#include "sim_server/low_rank/point_tiles.h"

#include <algorithm>
#include <numeric>

namespace palpate::sim {
namespace {

int longest_side(std::span<const int> some, std::span<const Vec3> points) {
  Vec3 low = points[some.front()], high = low;
  for (const int point : some) {
    low = low.cwiseMin(points[point]);
    high = high.cwiseMax(points[point]);
  }
  int side = 0;
  (high - low).maxCoeff(&side);
  return side;
}

/// Sorts `some` and adds where each of their tiles ends.
void halve(std::span<int> some, std::span<const Vec3> points, std::size_t most, std::vector<int>& ends) {
  if (some.size() <= most) {
    ends.push_back(ends.back() + static_cast<int>(some.size()));
    return;
  }
  const int side = longest_side(some, points);
  std::ranges::sort(some, {}, [&](int point) { return std::pair(points[point][side], point); });
  const std::size_t half = some.size() / 2;
  halve(some.first(half), points, most, ends);
  halve(some.subspan(half), points, most, ends);
}

}  // namespace

PointTiles tiles_of(std::span<const Vec3> points, int most) {
  PointTiles tiles{std::vector<int>(points.size()), {0}};
  std::iota(tiles.order.begin(), tiles.order.end(), 0);
  if (!points.empty()) halve(tiles.order, points, static_cast<std::size_t>(most), tiles.begins);
  return tiles;
}

}  // namespace palpate::sim
