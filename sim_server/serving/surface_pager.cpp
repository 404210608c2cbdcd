#include "sim_server/serving/surface_pager.h"

#include <algorithm>

#include "common/hash.h"
#include "sim_server/client_model/published_surface.h"

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
  std::ranges::sort(vertices, [&](int a, int b) {
    return rest[a][axis] != rest[b][axis] ? rest[a][axis] < rest[b][axis] : a < b;
  });
  const std::size_t half = clusters / 2 * kCluster;
  cluster(vertices.first(half), rest);
  cluster(vertices.subspan(half), rest);
}

}  // namespace

SurfacePager::SurfacePager(const Simulation& simulation, std::size_t tool)
    : simulation_(simulation),
      nearby_(simulation.published_surface()),
      published_(simulation.published_modes()),
      tool_(static_cast<std::uint8_t>(tool)) {
  find_surface();
  if (!simulation.tool(tool).shape().is_sphere()) return;  // the only shape that clients know
  const bool constant = published_ != nullptr || simulation.traits().constant_compliance;
  if (!constant || vertices_.size() > protocol::kMostSurfaceVertices) return;
  put_in_order();
  patch_.reserve(2 * kCluster, 0);
  patch_.free.resize(2 * kCluster);
  take_compliance(std::span(vertices_).first(1));
  state_ = {.vertices = static_cast<std::uint32_t>(vertices_.size()),
            .triangles = static_cast<std::uint32_t>(triangles_.size()),
            .tool_radius = simulation.tool(tool).shape().radius,
            .tool_friction = simulation.tool(tool).shape().friction,
            .tool_compliance = patch_.tool_compliance};
  state_.version = hash();
}

/// All that the tool can touch; of a surface that can be cut, its published part.
void SurfacePager::find_surface() {
  const auto is_published = [this](int v) {
    return nearby_ == nullptr || std::ranges::binary_search(nearby_->shape.vertices, v);
  };
  for (const Triangle& t : simulation_.touchable(tool_)) {
    if (!std::ranges::all_of(t, is_published)) continue;
    triangles_.push_back(t);
    vertices_.insert(vertices_.end(), t.begin(), t.end());
  }
  std::ranges::sort(vertices_);
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
}

void SurfacePager::put_in_order() {
  cluster(vertices_, simulation_.rest());
  std::vector<int> number(simulation_.rest().size(), -1);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    number[vertices_[i]] = static_cast<int>(i);
    rest_.push_back(simulation_.rest()[vertices_[i]]);
  }
  for (Triangle& t : triangles_) t = {number[t[0]], number[t[1]], number[t[2]]};
}

/// Hashes the geometry and how compliant each vertex is; of a surface that can be cut, which is published
/// while it is rendered, when it was published in place of that. Never 0.
std::uint32_t SurfacePager::hash() noexcept {
  Fnv1a hash;
  hash.add(triangles_.data(), triangles_.size() * sizeof(Triangle));
  hash.add(&state_.tool_radius, sizeof state_.tool_radius);
  hash.add(&state_.tool_compliance, sizeof state_.tool_compliance);
  if (nearby_) hash.add(&nearby_->model, sizeof nearby_->model);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    hash.add(rest_[i]);
    if (nearby_) continue;
    take_compliance({&vertices_[i], 1});
    hash.add(Vec3(patch_.compliance.topLeftCorner<3, 1>()));
  }
  if (published_ != nullptr) {
    const auto bytes = static_cast<std::size_t>(published_->published) * sizeof(double);
    hash.add(published_->frequencies.data(), bytes);
    hash.add(published_->damping.data(), bytes);
    for (const Relaxation& term : published_->relaxations) hash.add(&term, sizeof term);
  }
  return static_cast<std::uint32_t>(hash.value() ^ hash.value() >> 32) | 1;
}

bool SurfacePager::page(std::uint32_t number, SurfacePage& out) noexcept {
  const SurfacePages pages = this->pages();
  if (state_.version == 0 || number >= pages.count()) return false;
  out = {.tool = tool_, .version = state_.version, .page = number};
  if (number >= pages.first_tile()) {
    if (number < pages.spectrum()) {
      if (knows_tile(number))
        fill_tile(number, out);
      else
        out.page |= SurfacePages::kNotYet;
    } else if (number == pages.spectrum()) {
      fill_spectrum(out);
    } else {
      fill_shapes(number, out);
    }
    return true;
  }
  const bool positions = number < pages.first_triangle_page();
  const std::size_t size = positions ? vertices_.size() : triangles_.size(),
                    first = (positions ? number : number - pages.first_triangle_page()) * pages.kPerPage;
  for (std::size_t i = 0; i < pages.kPerPage && first + i < size; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out.values[3 * i + axis] = static_cast<float>(positions ? rest_[first + i][static_cast<int>(axis)]
                                                              : triangles_[first + i][axis]);
    }
  }
  return true;
}

std::span<const int> SurfacePager::members(std::size_t cluster) const noexcept {
  const std::size_t first = cluster * kCluster;
  return std::span(vertices_).subspan(first, std::min<std::size_t>(kCluster, vertices_.size() - first));
}

/// Into `patch_`: that of the tissue, or of all but its slow modes.
void SurfacePager::take_compliance(std::span<const int> vertices) noexcept {
  if (published_ == nullptr) return simulation_.model().compliance(vertices, patch_);
  patch_.tool_compliance = 0;
  if (nearby_) return nearby_->motion.residual_compliance(vertices, patch_);
  simulation_.traits().client->residual_compliance(vertices, patch_);
}

void SurfacePager::fill_spectrum(SurfacePage& out) const noexcept {
  for (Eigen::Index k = 0; k < published_->published; ++k) {
    out.values[3 * static_cast<std::size_t>(k)] = static_cast<float>(published_->frequencies[k]);
    out.values[3 * static_cast<std::size_t>(k) + 1] = static_cast<float>(published_->damping[k]);
  }
}

void SurfacePager::fill_shapes(std::uint32_t number, SurfacePage& out) const noexcept {
  const auto [cluster, group] = pages().cluster_and_group_of(number);
  const auto rows = members(cluster);
  const Eigen::Index first = group * SurfacePages::kModes,
                     count = std::min<Eigen::Index>(SurfacePages::kModes, published_->published - first);
  using Page = Eigen::Matrix<float, 3 * kCluster, SurfacePages::kModes, Eigen::RowMajor>;
  Eigen::Map<Page> page(out.values.data());
  for (std::size_t i = 0; i < rows.size(); ++i)
    page.block(3 * static_cast<Eigen::Index>(i), 0, 3, count) =
        published_->shapes.block(3 * rows[i], first, 3, count).cast<float>();
}

/// True if the compliance there is known by now.
bool SurfacePager::knows_tile(std::uint32_t number) const noexcept {
  if (nearby_ == nullptr) return true;
  const auto known = [this](int v) { return std::ranges::binary_search(nearby_->compliant.vertices, v); };
  const auto [a, b] = pages().clusters_of(number);
  return std::ranges::all_of(members(a), known) && std::ranges::all_of(members(b), known);
}

void SurfacePager::fill_tile(std::uint32_t number, SurfacePage& out) noexcept {
  const auto [a, b] = pages().clusters_of(number);
  const auto rows = members(a), columns = members(b);
  std::array<int, 2 * kCluster> both{};
  std::ranges::copy(columns, std::ranges::copy(rows, both.begin()).out);
  const std::size_t count = rows.size() + (a == b ? 0 : columns.size());
  take_compliance(std::span(both).first(count));
  const auto height = 3 * static_cast<Eigen::Index>(rows.size()),
             width = 3 * static_cast<Eigen::Index>(columns.size());
  using Tile = Eigen::Matrix<float, 3 * kCluster, 3 * kCluster, Eigen::RowMajor>;
  Eigen::Map<Tile>(out.values.data()).topLeftCorner(height, width) =
      patch_.compliance.block(0, a == b ? 0 : height, height, width).cast<float>();
}

}  // namespace palpate::sim
