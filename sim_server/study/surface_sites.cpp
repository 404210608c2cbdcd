#include "sim_server/study/surface_sites.h"

#include <limits>

#include "common/contact/simplex_distance.h"

namespace palpate::sim {

SurfaceSites::SurfaceSites(std::span<const Vec3> rest, const Surface& surface, std::span<const Vec3> sites) {
  for (const Vec3& place : sites) {
    Site nearest{};
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : surface.triangles) {
      const ClosestPoint found = closest_point(place, rest[t[0]], rest[t[1]], rest[t[2]]);
      const Vec3 weights(found.weight[0], found.weight[1], found.weight[2]);
      const double distance =
          (weights[0] * rest[t[0]] + weights[1] * rest[t[1]] + weights[2] * rest[t[2]] - place).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      nearest = {t, weights};
    }
    sites_.push_back(nearest);
  }
}

void SurfaceSites::add(std::span<const Vec3> rest, std::span<const Vec3> now,
                       std::vector<Vec3>& moved) const {
  for (const Site& site : sites_) {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < 3; ++i) sum += site.weights[i] * (now[site.corners[i]] - rest[site.corners[i]]);
    moved.push_back(sum);
  }
}

}  // namespace palpate::sim
