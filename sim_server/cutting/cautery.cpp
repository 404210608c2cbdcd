#include "sim_server/cutting/cautery.h"

#include <algorithm>

#include "common/contact/simplex_distance.h"

namespace palpate::sim {
namespace {

constexpr double kPart = 0.5, kMostParts = 64;  // of the way of a tip, in radii

/// True if a triangle's box comes within `reach` of a point: cheap, never wrong on the safe side.
bool may_reach(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, double reach) {
  return ((a.cwiseMin(b).cwiseMin(c).array() - reach) <= p.array()).all() &&
         ((a.cwiseMax(b).cwiseMax(c).array() + reach) >= p.array()).all();
}

}  // namespace

Cautery::Cautery(const Cutting& cutting, const TetMesh& mesh)
    : power_(cutting.power), spot_(cutting.spot), taken_(mesh.tetrahedra.size()) {
  for (const Tetrahedron& t : mesh.tetrahedra) needed_.push_back(cutting.energy * six_volumes(mesh, t) / 6);
}

/// Faces that take heat of a ball around `p`, by how much.
Cautery::Touched Cautery::touched_by(const Vec3& p, double radius, const CutMesh& mesh,
                                     const Surface& surface, std::span<const Vec3> positions) const {
  Touched touched;
  for (std::size_t slot = 0; slot < surface.triangles.size(); ++slot) {
    const Triangle& t = surface.triangles[slot];
    const Vec3 &a = positions[static_cast<std::size_t>(t[0])], &b = positions[static_cast<std::size_t>(t[1])],
               &c = positions[static_cast<std::size_t>(t[2])];
    if (!may_reach(a, b, c, p, radius + spot_)) continue;
    const auto w = closest_point(p, a, b, c).weight;
    const double gap = (p - w[0] * a - w[1] * b - w[2] * c).norm() - radius;
    if (!(gap < spot_)) continue;
    const int tetrahedron = mesh.tetrahedron_of(slot);
    if (!mesh.is_removable(tetrahedron)) {
      touched.end = true;
      continue;
    }
    const double area = 0.5 * (b - a).cross(c - a).norm();
    touched.exposed.push_back({tetrahedron, area * std::min(1.0, 1 - gap / spot_)});
  }
  return touched;
}

void Cautery::give(double joule, std::span<const Exposed> exposed, std::vector<int>& removed) {
  double all = 0;
  for (const Exposed& e : exposed) all += e.weight;
  if (!(all > 0)) return;
  spent_ += joule;
  for (const Exposed& e : exposed) {
    double& taken = taken_[static_cast<std::size_t>(e.tetrahedron)];
    taken += joule * e.weight / all;
    if (taken >= needed_[static_cast<std::size_t>(e.tetrahedron)]) removed.push_back(e.tetrahedron);
  }
}

std::vector<int> Cautery::heat(std::span<const HotTip> tips, const CutMesh& mesh, const Surface& surface,
                               std::span<const Vec3> positions, double dt) {
  std::vector<int> removed;
  for (const HotTip& tip : tips) {
    const Vec3 motion = tip.p_W - tip.from_W;
    const double parts = std::clamp(std::ceil(motion.norm() / (kPart * tip.radius)), 1.0, kMostParts);
    for (double k = 1; k <= parts; ++k) {
      const Touched touched =
          touched_by(tip.from_W + k / parts * motion, tip.radius, mesh, surface, positions);
      give(power_ * dt / parts, touched.exposed, removed);
      time_at_end_ += touched.end ? dt / parts : 0;
    }
  }
  std::ranges::sort(removed);
  removed.erase(std::unique(removed.begin(), removed.end()), removed.end());
  return removed;
}

}  // namespace palpate::sim
