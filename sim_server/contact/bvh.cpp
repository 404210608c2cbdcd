#include "sim_server/contact/bvh.h"

#include <algorithm>
#include <numeric>

namespace palpate::sim {
namespace {

constexpr int kGroup = 16;               // triangles
constexpr std::size_t kMostLoose = 256;  // triangles in no group
// A point of a triangle, as computed, may lie outside its box by rounding; m, up to places 1 km away.
constexpr double kRounding = 1e-9;

std::vector<Vec3> centres_of(std::span<const Vec3> x, std::span<const Triangle> triangles) {
  std::vector<Vec3> centres;
  for (const Triangle& t : triangles) centres.push_back((x[t[0]] + x[t[1]] + x[t[2]]) / 3);
  return centres;
}

}  // namespace

Bvh::Bvh(std::span<const Vec3> rest, std::span<const Triangle> triangles)
    : triangles_(triangles.size()), near_(triangles.size()) {
  std::iota(triangles_.begin(), triangles_.end(), 0);
  if (!triangles.empty())
    build(centres_of(rest, triangles), triangles, 0, static_cast<int>(triangles.size()));
  find_groups_of_vertices(rest.size());
  refit(rest);
}

/// Adds the node of a piece of triangles_, and all below it; halves it across its longest side.
void Bvh::build(std::span<const Vec3> centres, std::span<const Triangle> triangles, int begin, int end) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({.box = {}, .end = 0, .triangle = begin, .triangle_end = begin});
  if (end - begin <= kGroup) {
    const auto first = static_cast<long>(vertices_.size());
    for (int k = begin; k < end; ++k)
      vertices_.insert(vertices_.end(), triangles[triangles_[k]].begin(), triangles[triangles_[k]].end());
    std::sort(vertices_.begin() + first, vertices_.end());
    vertices_.erase(std::unique(vertices_.begin() + first, vertices_.end()), vertices_.end());
    nodes_[node].triangle_end = end;
    nodes_[node].vertex = static_cast<int>(first);
    nodes_[node].vertex_end = static_cast<int>(vertices_.size());
  } else {
    Eigen::AlignedBox3d box;
    for (int k = begin; k < end; ++k) box.extend(centres[triangles_[k]]);
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    const auto before = [&](int a, int b) {
      return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
    };
    std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle, triangles_.begin() + end,
                     before);
    build(centres, triangles, begin, middle);
    build(centres, triangles, middle, end);
  }
  nodes_[node].end = static_cast<int>(nodes_.size());
}

void Bvh::find_groups_of_vertices(std::size_t vertices) {
  first_group_.assign(vertices + 1, 0);
  for (const int vertex : vertices_) ++first_group_[static_cast<std::size_t>(vertex) + 1];
  std::partial_sum(first_group_.begin(), first_group_.end(), first_group_.begin());
  groups_.resize(vertices_.size());
  std::vector<int> next(first_group_.begin(), first_group_.end() - 1);
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    for (int k = nodes_[node].vertex; k < nodes_[node].vertex_end; ++k)
      groups_[static_cast<std::size_t>(next[static_cast<std::size_t>(vertices_[k])]++)] =
          static_cast<int>(node);
  }
  outdated_.assign(nodes_.size(), 0);
}

void Bvh::find_groups(std::size_t triangles) {
  group_of_.assign(triangles, -1);
  place_of_.assign(triangles, -1);
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    if (!is_group(nodes_[node])) continue;
    for (int k = nodes_[node].triangle; k < nodes_[node].triangle_end; ++k) {
      group_of_[static_cast<std::size_t>(triangles_[k])] = static_cast<int>(node);
      place_of_[static_cast<std::size_t>(triangles_[k])] = k;
    }
  }
}

/// Removes a triangle from its group, whose last triangle fills the gap, or from the loose ones.
void Bvh::take_out(int triangle) {
  int& group = group_of_[static_cast<std::size_t>(triangle)];
  if (group < 0) {
    std::erase(loose_, triangle);
    return;
  }
  const int place = place_of_[static_cast<std::size_t>(triangle)],
            last = triangles_[--nodes_[static_cast<std::size_t>(group)].triangle_end];
  triangles_[static_cast<std::size_t>(place)] = last;
  place_of_[static_cast<std::size_t>(last)] = place;
  group = -1;
}

void Bvh::change(std::span<const Vec3> rest, std::span<const Triangle> before,
                 std::span<const Triangle> now) {
  std::vector<int> changed;
  for (std::size_t i = 0; i < std::max(before.size(), now.size()); ++i) {
    if (i >= before.size() || i >= now.size() || before[i] != now[i]) changed.push_back(static_cast<int>(i));
  }
  if (nodes_.empty() || now.empty() || loose_.size() + changed.size() > kMostLoose) {
    *this = Bvh(rest, now);
    return;
  }
  if (group_of_.empty()) find_groups(before.size());
  for (const int i : changed) {
    if (static_cast<std::size_t>(i) < before.size()) take_out(i);
  }
  group_of_.resize(now.size(), -1);
  place_of_.resize(now.size(), -1);
  near_.resize(now.size());
  for (const int i : changed) {
    if (static_cast<std::size_t>(i) < now.size()) loose_.push_back(i);
  }
}

/// Fits a box to those below it, which are fitted.
void Bvh::fit(Node& node, std::span<const Vec3> positions) noexcept {
  if (!is_group(node)) {
    const Node& first = *(&node + 1);
    node.box = first.box.merged(nodes_[first.end].box);
    return;
  }
  Vec3 min = positions[vertices_[node.vertex]], max = min;
  for (int k = node.vertex + 1; k < node.vertex_end; ++k) {
    min = min.cwiseMin(positions[vertices_[k]]);
    max = max.cwiseMax(positions[vertices_[k]]);
  }
  node.box = Eigen::AlignedBox3d(min.array() - kRounding, max.array() + kRounding);
}

void Bvh::refit(std::span<const Vec3> positions) noexcept {
  for (std::size_t i = nodes_.size(); i-- > 0;) fit(nodes_[i], positions);
}

void Bvh::refit(std::span<const Vec3> positions, std::span<const int> moved) noexcept {
  constexpr std::size_t kFew = 4;  // times as many vertices as that: else all are fitted as soon
  if (kFew * moved.size() > first_group_.size()) return refit(positions);
  for (const int vertex : moved) {
    const auto v = static_cast<std::size_t>(vertex);
    for (int k = first_group_[v]; k < first_group_[v + 1]; ++k) outdated_[groups_[k]] = 1;
  }
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    if (!is_group(nodes_[i])) {
      char &first = outdated_[i + 1], &second = outdated_[nodes_[i + 1].end];
      outdated_[i] = first | second;
      first = second = 0;
    }
    if (outdated_[i] != 0) fit(nodes_[i], positions);
  }
  if (!outdated_.empty()) outdated_.front() = 0;
}

std::span<const int> Bvh::near(const Eigen::AlignedBox3d& box) noexcept {
  auto last = near_.begin();
  for (int i = 0; i < static_cast<int>(nodes_.size());) {
    const Node& node = nodes_[i];
    if (!node.box.intersects(box)) {
      i = node.end;
      continue;
    }
    last = std::copy(triangles_.begin() + node.triangle, triangles_.begin() + node.triangle_end, last);
    ++i;
  }
  last = std::ranges::copy(loose_, last).out;
  std::sort(near_.begin(), last);
  return {near_.begin(), last};
}

}  // namespace palpate::sim
