#include "protocol/near_tiles.h"

#include <algorithm>
#include <limits>

namespace palpate::protocol {

NearTiles::NearTiles(std::size_t most_vertices) {
  const std::size_t clusters = (most_vertices + SurfacePages::kCluster - 1) / SurfacePages::kCluster;
  center_.reserve(clusters);
  radius_.reserve(clusters);
  near_.reserve(clusters);
}

void NearTiles::take(std::span<const Vec3> rest) noexcept {
  center_.clear();
  radius_.clear();
  near_.clear();
  for (std::size_t first = 0; first < rest.size(); first += SurfacePages::kCluster) {
    const auto members =
        rest.subspan(first, std::min<std::size_t>(SurfacePages::kCluster, rest.size() - first));
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : members) sum += x;
    const Vec3 center = sum / static_cast<double>(members.size());
    double radius = 0;
    for (const Vec3& x : members) radius = std::max(radius, (x - center).norm());
    center_.push_back(center);
    radius_.push_back(radius);
  }
}

void NearTiles::search(const Vec3& p) noexcept {
  near_.clear();
  for (std::uint32_t c = 0; c < center_.size(); ++c)
    near_.emplace_back((center_[c] - p).norm() - radius_[c], c);
  const std::size_t most = std::min(kMostClusters, near_.size());
  std::partial_sort(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(most), near_.end());
  near_.resize(most);
}

double NearTiles::distance() const noexcept {
  return near_.empty() ? std::numeric_limits<double>::infinity() : near_.front().first;
}

}  // namespace palpate::protocol
