#include "sim_server/cutting/cautery.h"

#include <algorithm>

#include "common/contact/simplex_distance.h"

namespace palpate::sim {
namespace {

struct Exposed {
  int tetrahedron;
  double weight;  // m^2
};

/// Whether a triangle's box comes within `reach` of a point: cheap, never wrong on the safe side.
bool may_reach(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, double reach) {
  return ((a.cwiseMin(b).cwiseMin(c).array() - reach) <= p.array()).all() &&
         ((a.cwiseMax(b).cwiseMax(c).array() + reach) >= p.array()).all();
}

}  // namespace

Cautery::Cautery(const Cutting& cutting, const TetMesh& mesh)
    : power_(cutting.power), spot_(cutting.spot), taken_(mesh.tetrahedra.size()) {
  for (const Tetrahedron& t : mesh.tetrahedra) needed_.push_back(cutting.energy * six_volumes(mesh, t) / 6);
}

std::vector<int> Cautery::heat(std::span<const HotTip> tips, const CutMesh& mesh, const Surface& surface,
                               std::span<const Vec3> positions, double dt) {
  std::vector<int> gone;
  for (const HotTip& tip : tips) {
    std::vector<Exposed> exposed;
    double all = 0;
    for (std::size_t slot = 0; slot < surface.triangles.size(); ++slot) {
      const Triangle& t = surface.triangles[slot];
      const Vec3 &a = positions[static_cast<std::size_t>(t[0])],
                 &b = positions[static_cast<std::size_t>(t[1])],
                 &c = positions[static_cast<std::size_t>(t[2])];
      if (!may_reach(a, b, c, tip.p_W, tip.radius + spot_)) continue;
      const int tetrahedron = mesh.tetrahedron_of(slot);
      if (!mesh.is_removable(tetrahedron)) continue;
      const auto w = closest_point(tip.p_W, a, b, c).weight;
      const double gap = (tip.p_W - w[0] * a - w[1] * b - w[2] * c).norm() - tip.radius;
      if (!(gap < spot_)) continue;
      const double area = 0.5 * (b - a).cross(c - a).norm();
      exposed.push_back({tetrahedron, area * std::min(1.0, 1 - gap / spot_)});
      all += exposed.back().weight;
    }
    if (!(all > 0)) continue;
    spent_ += power_ * dt;
    for (const Exposed& e : exposed) {
      double& taken = taken_[static_cast<std::size_t>(e.tetrahedron)];
      taken += power_ * dt * e.weight / all;
      if (taken >= needed_[static_cast<std::size_t>(e.tetrahedron)]) gone.push_back(e.tetrahedron);
    }
  }
  std::sort(gone.begin(), gone.end());
  gone.erase(std::unique(gone.begin(), gone.end()), gone.end());
  return gone;
}

}  // namespace palpate::sim
