#include "sim_server/elasticity/inversion.h"

namespace palpate::sim {
namespace {

// Of the product of three edges from one corner: what spans less at rest is a sliver.
constexpr double kSliver = 0.01;

}  // namespace

bool any_inverted(const Solid& solid, std::span<const Vec3> x) {
  for (std::size_t e = 0; e < solid.elements(); ++e) {
    const std::span<const int> t = solid.element(e);
    const auto edge = [&](std::span<const Vec3> at, std::size_t k) -> Vec3 { return at[t[k]] - at[t[0]]; };
    const auto spanned = [&](std::span<const Vec3> at) {
      return edge(at, 1).cross(edge(at, 2)).dot(edge(at, 3));
    };
    if (spanned(x) > 0) continue;
    const std::span<const Vec3> rest = solid.rest();
    const double edges = edge(rest, 1).norm() * edge(rest, 2).norm() * edge(rest, 3).norm();
    if (spanned(rest) > kSliver * edges) return true;
  }
  return false;
}

}  // namespace palpate::sim
