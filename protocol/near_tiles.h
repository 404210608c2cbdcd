#pragma once
#include <span>
#include <utility>
#include <vector>

#include "common/types.h"
#include "protocol/surface_pages.h"

namespace palpate::protocol {

/// Which tiles of a surface (surface_pages.h) matter to a tool at a place: what a client asks for, and what
/// is put into a capture in its stead. Nothing but the constructor allocates.
class NearTiles {
 public:
  /// Clusters around the tool that are looked at: all pairs of them have room in a client.
  static constexpr std::size_t kMostClusters = 120;
  /// Tiles that a client keeps; then it forgets the oldest.
  static constexpr std::size_t kStored = 8192;
  static_assert(kMostClusters * (kMostClusters + 1) / 2 <= kStored);

  /// Allocates for surfaces of at most this number of vertices.
  explicit NearTiles(std::size_t most_vertices);

  /// Takes the surface at rest, m.
  void take(std::span<const Vec3> rest) noexcept;

  /// Returns the distance (m) up to which tiles matter around a tool of that radius (m) and speed (m/s). It
  /// covers the extent of its load on the tissue, and its motion while a page is on its way.
  static double reach(double radius, double speed) noexcept { return 3 * radius + 0.2 * speed; }

  /// Looks around `p` (m, at rest).
  void search(const Vec3& p) noexcept;
  /// Returns the distance of `p` from the ball around the nearest cluster, m; below 0: within. Infinite
  /// without a surface.
  double distance() const noexcept;
  /// Calls `work(a, b)` for pairs of clusters that lie within `reach` of one place, those nearest to `p`
  /// first, until it says false.
  template <class Work>
  void for_pairs(double reach, const Work& work) const {
    for (std::size_t i = 0; i < near_.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const auto [a, b] = std::pair(near_[i].second, near_[j].second);
        const bool far = (center_[a] - center_[b]).norm() > 2 * reach + radius_[a] + radius_[b];
        if (!far && !work(a, b)) return;
      }
    }
  }

 private:
  std::vector<Vec3> center_;                            // of the ball around each cluster, m
  std::vector<double> radius_;                          // of the same, m
  std::vector<std::pair<double, std::uint32_t>> near_;  // distance (m) of clusters, the nearest first
};

}  // namespace palpate::protocol
