#pragma once
#include <span>
#include <vector>

#include "common/types.h"

namespace palpate::sim {

/// Points in tiles of neighbours.
struct PointTiles {
  std::vector<int> order;   ///< (n) numbers of points, tile after tile
  std::vector<int> begins;  ///< (tiles + 1) where each begins in `order`; last: n
};

/// Tiles of at most `most` points (m): halved at the median along the longest side of their box until they
/// are that small, so that all are about as large. The same on every machine. O(n log^2 n).
PointTiles tiles_of(std::span<const Vec3> points, int most);

}  // namespace palpate::sim
