#include "sim_server/serving/surface_pager.h"

#include <algorithm>

#include "common/hash.h"

namespace palpate::sim {
using protocol::SurfacePage;
using protocol::SurfacePages;

namespace {

constexpr int kCluster = SurfacePages::kCluster;

/// Orders vertices so that each `kCluster` in a row lie close together: halves them, at whole clusters,
/// across their longest side (Bentley 1975, k-d tree).
void cluster(std::span<int> vertices, const std::vector<Vec3>& rest) {
  const std::size_t clusters = (vertices.size() + kCluster - 1) / kCluster;
  if (clusters < 2) return;
  Vec3 low = rest[vertices.front()], high = low;
  for (const int v : vertices) {
    low = low.cwiseMin(rest[v]);
    high = high.cwiseMax(rest[v]);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::sort(vertices.begin(), vertices.end(), [&](int a, int b) {
    return rest[a][axis] != rest[b][axis] ? rest[a][axis] < rest[b][axis] : a < b;
  });
  const std::size_t half = clusters / 2 * kCluster;
  cluster(vertices.first(half), rest);
  cluster(vertices.subspan(half), rest);
}

}  // namespace

SurfacePager::SurfacePager(const Simulation& simulation, std::size_t tool)
    : simulation_(simulation), tool_(static_cast<std::uint8_t>(tool)) {
  const auto touchable = simulation.touchable(tool);
  for (const Triangle& t : touchable) vertices_.insert(vertices_.end(), t.begin(), t.end());
  std::sort(vertices_.begin(), vertices_.end());
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  if (!simulation.tool(tool).shape().is_sphere()) return;  // the only shape that clients know
  if (!simulation.model().compliance_is_constant() || vertices_.size() > protocol::kMostSurfaceVertices)
    return;
  put_in_order();
  patch_.reserve(2 * kCluster, 0);
  patch_.free.resize(2 * kCluster);
  simulation_.model().compliance(std::span(vertices_).first(1), patch_);
  state_ = {.vertices = static_cast<std::uint32_t>(vertices_.size()),
            .triangles = static_cast<std::uint32_t>(triangles_.size()),
            .tool_radius = simulation.tool(tool).shape().radius,
            .tool_friction = simulation.tool(tool).shape().friction,
            .tool_compliance = patch_.tool_compliance};
  state_.version = hash();
}

void SurfacePager::put_in_order() {
  cluster(vertices_, simulation_.rest());
  std::vector<int> number(simulation_.rest().size(), -1);
  for (std::size_t i = 0; i < vertices_.size(); ++i) number[vertices_[i]] = static_cast<int>(i);
  for (const Triangle& t : simulation_.touchable(tool_))
    triangles_.push_back({number[t[0]], number[t[1]], number[t[2]]});
}

/// Of the geometry and of how compliant each vertex is; never 0.
std::uint32_t SurfacePager::hash() noexcept {
  Fnv1a hash;
  hash.add(triangles_.data(), triangles_.size() * sizeof(Triangle));
  hash.add(&state_.tool_radius, sizeof state_.tool_radius);
  hash.add(&state_.tool_compliance, sizeof state_.tool_compliance);
  for (const int& vertex : vertices_) {
    hash.add(simulation_.rest()[vertex]);
    simulation_.model().compliance({&vertex, 1}, patch_);
    hash.add(Vec3(patch_.compliance.topLeftCorner<3, 1>()));
  }
  return static_cast<std::uint32_t>(hash.value() ^ hash.value() >> 32) | 1;
}

std::vector<Vec3> SurfacePager::rest() const {
  std::vector<Vec3> rest;
  for (const int vertex : vertices_) rest.push_back(simulation_.rest()[vertex]);
  return rest;
}

bool SurfacePager::page(std::uint32_t number, SurfacePage& out) noexcept {
  const SurfacePages pages{state_.vertices, state_.triangles};
  if (state_.version == 0 || number >= pages.count()) return false;
  out = {.tool = tool_, .version = state_.version, .page = number};
  if (number >= pages.first_tile()) {
    fill_tile(number, out);
    return true;
  }
  const bool positions = number < pages.first_triangle_page();
  const std::size_t size = positions ? vertices_.size() : triangles_.size(),
                    first = (positions ? number : number - pages.first_triangle_page()) * pages.kPerPage;
  for (std::size_t i = 0; i < pages.kPerPage && first + i < size; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out.values[3 * i + axis] =
          static_cast<float>(positions ? simulation_.rest()[vertices_[first + i]][static_cast<int>(axis)]
                                       : triangles_[first + i][axis]);
    }
  }
  return true;
}

void SurfacePager::fill_tile(std::uint32_t number, SurfacePage& out) noexcept {
  const auto [a, b] = SurfacePages{state_.vertices, state_.triangles}.clusters_of(number);
  const auto members = [&](std::size_t cluster) {
    const std::size_t first = cluster * kCluster;
    return std::span(vertices_).subspan(first, std::min<std::size_t>(kCluster, vertices_.size() - first));
  };
  const auto rows = members(a), columns = members(b);
  std::array<int, 2 * kCluster> both{};
  std::copy(columns.begin(), columns.end(), std::copy(rows.begin(), rows.end(), both.begin()));
  const std::size_t count = rows.size() + (a == b ? 0 : columns.size());
  simulation_.model().compliance(std::span(both).first(count), patch_);
  const auto height = 3 * static_cast<Eigen::Index>(rows.size()),
             width = 3 * static_cast<Eigen::Index>(columns.size());
  using Tile = Eigen::Matrix<float, 3 * kCluster, 3 * kCluster, Eigen::RowMajor>;
  Eigen::Map<Tile>(out.values.data()).topLeftCorner(height, width) =
      patch_.compliance.block(0, a == b ? 0 : height, height, width).cast<float>();
}

}  // namespace palpate::sim
