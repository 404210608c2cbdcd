#pragma once
/// Layout of the pages (`SurfacePage`) of a surface model, each one datagram. Client and server count alike.
///
/// The model: rest positions of n vertices (m, world), triangles (corners: vertex numbers, outward), and the
/// static compliance of the vertices to each other, 3 x 3 blocks C(i, j) = dx_i / df_j (m/N), symmetric. Of a
/// tissue that swings also its slow modes, q'' + d q' + w^2 q = s^T f; the compliance is then that of all but
/// these. The server orders vertices so that neighbours have near numbers; each `kCluster` of them in a row
/// are a cluster. Pages, in this order, every number a float32:
///   positions   `kPerPage` vertices a page: x y z each
///   triangles   `kPerPage` triangles a page: three vertex numbers each
///   tiles       one page for each pair of clusters (a, b), b <= a, in the order (0,0) (1,0) (1,1) (2,0) ..:
///               C(kCluster a + i, kCluster b + j) as a (3 kCluster x 3 kCluster) matrix, row by row
///   spectrum    where there are modes, one page: w of mode k (rad/s) at 3 k, d (1/s) at 3 k + 1
///   shapes      for each cluster, `groups()` pages: s (1/sqrt(kg)) of modes `kModes` g to `kModes` g + 14 at
///   its
///               vertices, as a (3 kCluster x kModes) matrix, row by row
/// Numbers beyond the last vertex or triangle are 0. A tile of tissue that can be cut may be known later than
/// the rest (`SurfacePages::kNotYet`).
#include <cmath>
#include <cstdint>
#include <utility>

#include "protocol/messages.h"

namespace palpate::protocol {

/// The pages of a model of so many vertices and triangles.
struct SurfacePages {
  static constexpr std::uint32_t kCluster = SurfacePage::kCluster;
  static constexpr std::uint32_t kPerPage = SurfacePage::kValues / 3;             ///< vertices, or triangles
  static constexpr std::uint32_t kModes = SurfacePage::kValues / (3 * kCluster);  ///< on a page of shapes
  /// Added to the number of a page that is asked for before the server knows it: it will, ask again later.
  /// Its values are 0.
  static constexpr std::uint32_t kNotYet = 1U << 31U;
  static_assert(3 * kMaxPublishedModes <= SurfacePage::kValues);
  std::uint32_t vertices = 0, triangles = 0, modes = 0;

  std::uint32_t clusters() const noexcept { return (vertices + kCluster - 1) / kCluster; }
  std::uint32_t first_triangle_page() const noexcept { return (vertices + kPerPage - 1) / kPerPage; }
  std::uint32_t first_tile() const noexcept {
    return first_triangle_page() + (triangles + kPerPage - 1) / kPerPage;
  }
  /// The page behind the last tile: the spectrum, where there are modes.
  std::uint32_t spectrum() const noexcept { return first_tile() + clusters() * (clusters() + 1) / 2; }
  std::uint32_t groups() const noexcept { return (modes + kModes - 1) / kModes; }
  std::uint32_t count() const noexcept { return spectrum() + (modes > 0 ? 1 + clusters() * groups() : 0); }

  /// Page of the clusters a and b, in any order.
  std::uint32_t tile(std::uint32_t a, std::uint32_t b) const noexcept {
    if (a < b) std::swap(a, b);
    return first_tile() + a * (a + 1) / 2 + b;
  }
  /// Calls `work` with each page that a client wants of a pair of clusters: their tile, and of a cluster with
  /// itself also its shapes.
  template <class Work>
  void for_clusters(std::uint32_t a, std::uint32_t b, const Work& work) const {
    work(tile(a, b));
    for (std::uint32_t group = 0; a == b && group < groups(); ++group) work(shapes(a, group));
  }
  /// Page of the shapes of a group of modes at a cluster.
  std::uint32_t shapes(std::uint32_t cluster, std::uint32_t group) const noexcept {
    return spectrum() + 1 + cluster * groups() + group;
  }
  /// Cluster and group of such a page.
  std::pair<std::uint32_t, std::uint32_t> cluster_and_group_of(std::uint32_t page) const noexcept {
    const std::uint32_t k = page - spectrum() - 1;
    return {k / groups(), k % groups()};
  }
  /// Clusters (a, b), b <= a, of a tile's page.
  std::pair<std::uint32_t, std::uint32_t> clusters_of(std::uint32_t page) const noexcept {
    const std::uint32_t k = page - first_tile();
    auto a = static_cast<std::uint32_t>((std::sqrt(8.0 * k + 1) - 1) / 2);
    while (a * (a + 1) / 2 > k) --a;
    while ((a + 1) * (a + 2) / 2 <= k) ++a;
    return {a, k - a * (a + 1) / 2};
  }
};

}  // namespace palpate::protocol
