#include "sim_server/elasticity/inversion.h"

#include <algorithm>
#include <cmath>

namespace palpate::sim {
namespace {

// Six volumes, of the cube of the longest edge: what spans less at rest is a sliver (a regular one: 0.7).
constexpr double kSliver = 0.01;

constexpr double kSnaps = 0.49;  // Poisson's ratio: above it, corotational tissue snaps through

double longest_edge(const Solid& solid, std::span<const int> t) {
  double longest = 0;
  for (const auto& [a, b] : kEdges)
    longest = std::max(longest, (solid.rest()[t[a]] - solid.rest()[t[b]]).norm());
  return longest;
}

}  // namespace

bool any_inverted(const Solid& solid, std::span<const Vec3> x) {
  for (std::size_t e = 0; e < solid.elements(); ++e) {
    if (solid.is_removed(e)) continue;
    const std::span<const int> t = solid.element(e);
    const auto edge = [&](std::span<const Vec3> at, std::size_t k) -> Vec3 { return at[t[k]] - at[t[0]]; };
    const auto spanned = [&](std::span<const Vec3> at) {
      return edge(at, 1).cross(edge(at, 2)).dot(edge(at, 3));
    };
    if (spanned(x) > 0) continue;
    if (spanned(solid.rest()) > kSliver * std::pow(longest_edge(solid, t), 3)) return true;
  }
  return false;
}

bool may_stay_inverted(const Material& material) {
  return material.law == ElasticLaw::kStVenantKirchhoff ||
         (material.law == ElasticLaw::kCorotational && material.poisson_ratio > kSnaps);
}

}  // namespace palpate::sim
