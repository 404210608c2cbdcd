#include "sim_server/scene/held_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::sim {
namespace {

/// Returns which [[fixed]] each corner belongs to: -1 for a free one.
std::vector<int> region_of_corners(const Scene& scene, const TetMesh& mesh) {
  std::vector<int> region(static_cast<std::size_t>(mesh.corners()), -1);
  for (std::size_t r = scene.fixed.size(); r-- > 0;) {
    for (const int vertex : vertices_in(scene.fixed[r], mesh)) region[vertex] = static_cast<int>(r);
  }
  return region;
}

Vec3 along_axes(Vec3 displacement, int axes) {
  for (int axis = 0; axis < 3; ++axis) {
    if ((axes >> axis & 1) == 0) displacement[axis] = 0;
  }
  return displacement;
}

}  // namespace

double angle_at(const SupportMotion& motion, double t) {
  return 2 * std::numbers::pi * t / motion.period + motion.phase;
}

double displacement_at(const SupportMotion& motion, double t) {
  return motion.amplitude * std::sin(angle_at(motion, t));
}

bool supports_move(const Scene& scene) {
  return std::ranges::any_of(scene.fixed, [](const FixedRegion& region) { return region.moves(); });
}

std::vector<HeldMotion> held_motions(const Scene& scene, const TetMesh& mesh,
                                     std::span<const HeldAxes> held) {
  std::vector<HeldMotion> all;
  if (!supports_move(scene)) return all;
  const std::vector<int> region_of = region_of_corners(scene, mesh);
  for (std::size_t r = 0; r < scene.fixed.size(); ++r) {
    const auto fraction = [&](std::size_t vertex) {
      return region_of[vertex] == static_cast<int>(r) ? 1.0 : 0;
    };
    for (const SupportMotion& motion : scene.fixed[r].motions) {
      HeldMotion one{motion, {}, scene.fixed[r].where};
      const auto add = [&](std::size_t node, double part) {
        const Vec3 displacement = part * along_axes(motion.direction, scene.fixed[r].axes & held[node]);
        if (!displacement.isZero(0)) one.nodes.emplace_back(static_cast<int>(node), displacement);
      };
      for (std::size_t v = 0; v < region_of.size(); ++v) add(v, fraction(v));
      for (std::size_t k = 0; k < mesh.mid_edges.size(); ++k)
        add(region_of.size() + k, 0.5 * (fraction(mesh.mid_edges[k][0]) + fraction(mesh.mid_edges[k][1])));
      all.push_back(std::move(one));
    }
  }
  return all;
}

}  // namespace palpate::sim
