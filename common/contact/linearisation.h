#pragma once
#include "common/types.h"

namespace palpate {

/// Force on a tool near a place, to first order: F(p) = f + K (p - place) in contact; free of it, the nearest
/// surface and how stiff it will be. World frame.
struct Linearisation {
  Vec3 p_W = Vec3::Zero();       ///< place of the tool, m
  Vec3 f_W = Vec3::Zero();       ///< force there, N; zero: free
  Mat3 tangent = Mat3::Zero();   ///< K = dF/dp, N/m, symmetric: xx, xy, xz, yy, yz, zz
  Vec3 normal_W = Vec3::Zero();  ///< outward, unit; zero: no surface near
  double gap = 0;                ///< m from tool to surface; 0 in contact
};

}  // namespace palpate
