#pragma once
#include <Eigen/Geometry>
#include <span>

#include "common/types.h"

namespace palpate::sim {

/// The least box, along the axes, around all `places`; empty (`isEmpty`) around none. O(places).
inline Eigen::AlignedBox3d bounding_box(std::span<const Vec3> places) noexcept {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : places) box.extend(x);
  return box;
}

/// Returns the diagonal of that box, m: the size of a body.
inline double diagonal_of(std::span<const Vec3> places) noexcept {
  return bounding_box(places).diagonal().norm();
}

}  // namespace palpate::sim
