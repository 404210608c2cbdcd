#pragma once
#include <span>

#include "common/types.h"

namespace palpate {

/// Force on one vertex of the surface.
struct VertexLoad {
  int vertex = 0;
  Vec3 force = Vec3::Zero();  ///< N, world
  bool operator==(const VertexLoad&) const = default;
};

/// Returns the fraction of `sum` that a load contributes along it, 0 where the sum is 0. The fractions of all
/// loads add up to 1.
inline double fraction_of(const VertexLoad& load, const Vec3& sum) {
  const double size = sum.squaredNorm();
  return size > 0 ? load.force.dot(sum) / size : 0;
}
/// Returns the sum of the forces of these loads, N.
inline Vec3 sum_of(std::span<const VertexLoad> loads) {
  Vec3 sum = Vec3::Zero();
  for (const VertexLoad& load : loads) sum += load.force;
  return sum;
}

}  // namespace palpate
