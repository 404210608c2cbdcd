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

/// Motion of the surface near this tool by the other tools on the organ, to first order.
struct OtherTools {
  Vec3 v_W = Vec3::Zero();  ///< at that velocity, with the force of this tool held, m/s
  /// Compliance of the other tools: additional motion for each N more of this tool's load on the tissue, m/N,
  /// symmetric, in the order of `tangent`.
  Mat3 compliance = Mat3::Zero();
};

}  // namespace palpate
