#pragma once
#include <Eigen/Geometry>
#include <limits>
#include <span>
#include <vector>

#include "sim_server/mesh/surface.h"

namespace palpate::sim {

/// Boxes around groups of triangles that lie near each other, boxes around pairs of these, and so on up to
/// one: what is far is passed over in few questions. The tree is that of the surface it was built on; `refit`
/// fits the boxes to that surface deformed. Triangles are known by their index in the list it was built on.
/// Nothing but the constructor and `change` allocates. One thread.
class Bvh {
 public:
  /// `rest`: surface vertices, m. O(n log^2 n).
  Bvh(std::span<const Vec3> rest, std::span<const Triangle> triangles);

  /// Replaces the triangles `before` by `now`, of the same vertices. Triangles that are not in their place
  /// any more leave their boxes, and those that are new there are looked at one by one, until there are some
  /// hundred: then the tree is built anew. O(n) comparisons.
  void change(std::span<const Vec3> rest, std::span<const Triangle> before, std::span<const Triangle> now);

  /// Refits the boxes to the present positions. Reads each about once: O(n), but a fraction of a pass over
  /// the triangles.
  void refit(std::span<const Vec3> positions) noexcept;
  /// Refits where only these vertices may have moved since the last call. O(those), and one look at each box.
  void refit(std::span<const Vec3> positions, std::span<const int> moved) noexcept;

  /// Returns the triangles whose own box overlaps `box`, and some neighbours, ascending. Valid until the next
  /// call.
  std::span<const int> near(const Eigen::AlignedBox3d& box) noexcept;

  /// The triangle that `squared_distance` (of a triangle, m^2; at least that of its box) says is
  /// nearest to `to`, of equals the first in the list; -1: there is none.
  template <class SquaredDistance>
  int nearest(const Eigen::AlignedBox3d& to, SquaredDistance squared_distance) const noexcept;

 private:
  /// Node of the tree in depth-first order: its first child comes next, its second where the first one ends.
  struct Node {
    Eigen::AlignedBox3d box;
    int end;                         // of all below it
    int triangle, triangle_end;      // in triangles_; of a group those that have not left it
    int vertex = 0, vertex_end = 0;  // in vertices_, of a group
  };
  bool is_group(const Node& node) const { return node.vertex < node.vertex_end; }
  void fit(Node& node, std::span<const Vec3> positions) noexcept;
  void find_groups(std::size_t triangles);
  void find_groups_of_vertices(std::size_t vertices);
  void take_out(int triangle);
  void build(std::span<const Vec3> centres, std::span<const Triangle> triangles, int begin, int end);

  std::vector<Node> nodes_;
  std::vector<int> triangles_, vertices_;  // of the groups, one after the other
  std::vector<int> first_group_, groups_;  // that each vertex is in, from first_group_[v] to [v + 1]
  std::vector<char> outdated_;             // of nodes, in `refit`
  std::vector<int> near_;
  // Since a change: triangles in no group; of each its group, or -1, and its place in triangles_.
  std::vector<int> loose_, group_of_, place_of_;
};

template <class SquaredDistance>
int Bvh::nearest(const Eigen::AlignedBox3d& to, SquaredDistance squared_distance) const noexcept {
  double best = std::numeric_limits<double>::max();
  int nearest = -1;
  const auto observe = [&](int triangle) {
    const double distance = squared_distance(triangle);
    if (distance > best || (distance == best && triangle >= nearest)) return;
    best = distance;
    nearest = triangle;
  };
  const auto search = [&](const Node& group) {
    for (int k = group.triangle; k < group.triangle_end; ++k) observe(triangles_[k]);
  };
  const auto away = [&](int node) { return nodes_[node].box.squaredExteriorDistance(to); };
  const int end = static_cast<int>(nodes_.size());
  if (end == 0) return -1;
  int likely = 0;  // first, so that the rest is soon seen to be farther
  while (!is_group(nodes_[likely])) {
    const int first = likely + 1, second = nodes_[first].end;
    likely = away(first) <= away(second) ? first : second;
  }
  search(nodes_[likely]);
  for (const int triangle : loose_) observe(triangle);
  for (int i = 0; i < end;) {
    if (away(i) > best) {
      i = nodes_[i].end;
      continue;
    }
    if (is_group(nodes_[i])) search(nodes_[i]);
    ++i;
  }
  return nearest;
}

}  // namespace palpate::sim
