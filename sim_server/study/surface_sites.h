#pragma once
#include <span>

#include "sim_server/mesh/surface.h"

namespace palpate::sim {

/// Places on a surface, each between the corners of the triangle that it is nearest to at rest: so that
/// surfaces of several meshes can be compared there.
class SurfaceSites {
 public:
  /// `rest`: surface vertices, m. O(sites x triangles).
  SurfaceSites(std::span<const Vec3> rest, const Surface& surface, std::span<const Vec3> sites);

  /// Appends how far each site is moved where the vertices are at `now`, m.
  void add(std::span<const Vec3> rest, std::span<const Vec3> now, std::vector<Vec3>& moved) const;

 private:
  struct Site {
    Triangle corners;
    Vec3 weights;  // barycentric
  };
  std::vector<Site> sites_;
};

}  // namespace palpate::sim
