#include "sim_server/explicit/near_tools.h"

#include <algorithm>
#include <cmath>

namespace palpate::sim {

void NearTools::search_in(std::span<const Neighbourhood> places, std::span<const Triangle> triangles,
                          std::span<const int> in_motion, std::span<const Vec3> positions,
                          double path) noexcept {
  for (const int vertex : vertices_) has_[static_cast<std::size_t>(vertex)] = 0;
  vertices_.clear();
  narrowed_ = !places.empty();
  if (!narrowed_) return;
  for (const Triangle& triangle : triangles) {
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return positions[static_cast<std::size_t>(triangle[k])];
    };
    // No point of it is farther than that from its first corner.
    const double longest =
        std::sqrt(std::max((corner(1) - corner(0)).squaredNorm(), (corner(2) - corner(0)).squaredNorm()));
    const auto is_in = [&](const Neighbourhood& place) {
      return (corner(0) - place.middle).norm() <= place.radius + longest + path;
    };
    if (std::ranges::none_of(places, is_in)) continue;
    for (const int vertex : triangle) {
      if (in_motion[static_cast<std::size_t>(vertex)] >= 0) add(vertex);
    }
  }
}

bool NearTools::add(int vertex) noexcept {
  char& has = has_[static_cast<std::size_t>(vertex)];
  if (has != 0) return false;
  has = 1;
  vertices_.push_back(vertex);
  return true;
}

}  // namespace palpate::sim
