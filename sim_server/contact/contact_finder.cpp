#include "sim_server/contact/contact_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::sim {
namespace {

constexpr double kMostBalls = 3;   // as dense as the densest, along an axis
constexpr double kNothing = 1e-9;  // m

/// True if the triangle's bounding box comes within `reach` of that of p and q: cheap, never wrong on the
/// safe side.
bool may_reach(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& q,
               double reach) noexcept {
  return ((a.cwiseMin(b).cwiseMin(c).array() - reach) <= p.cwiseMax(q).array()).all() &&
         ((a.cwiseMax(b).cwiseMax(c).array() + reach) >= p.cwiseMin(q).array()).all();
}

/// Around what lies within `reach` of p or q, or between.
Eigen::AlignedBox3d box_around(const Vec3& p, const Vec3& q, double reach) noexcept {
  return {p.cwiseMin(q).array() - reach, p.cwiseMax(q).array() + reach};
}

/// True if the axis from p to q comes within `reach` of the triangle.
bool reaches(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& q,
             double reach) noexcept {
  if (reach < 0) return false;
  if (p != q) return segment_triangle_distance(p, q, a, b, c) <= reach;
  const auto w = closest_point(p, a, b, c).weight;
  return (p - w[0] * a - w[1] * b - w[2] * c).squaredNorm() <= reach * reach;
}

/// m. A ray from a place that somebody chose may meet edges and vertices of a mesh that was made as a grid;
/// none so little beside it.
const Vec3 kBesideEdges(0, 1.3e-12, 2.7e-12);

/// 1 where the ray from `p` along x leaves through the triangle, -1 where it enters, else 0.
int crossing(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& p) noexcept {
  const auto all_beyond = [&](int axis) {
    return (x0[axis] > p[axis] && x1[axis] > p[axis] && x2[axis] > p[axis]) ||
           (x0[axis] < p[axis] && x1[axis] < p[axis] && x2[axis] < p[axis]);
  };
  if (all_beyond(1) || all_beyond(2)) return 0;
  const Vec3 a = x0 - p, b = x1 - p, c = x2 - p;
  // Signed areas of the projections along x of p with each edge: of one sign, p is between the edges.
  const double ab = a.y() * b.z() - a.z() * b.y(), bc = b.y() * c.z() - b.z() * c.y(),
               ca = c.y() * a.z() - c.z() * a.y();
  const bool outward = ab > 0 && bc > 0 && ca > 0;
  if (!outward && !(ab < 0 && bc < 0 && ca < 0)) return 0;
  const double ahead = a.x() * bc + b.x() * ca + c.x() * ab;  // times their sum: how far along x
  return outward ? (ahead > 0 ? 1 : 0) : (ahead < 0 ? -1 : 0);
}

}  // namespace

ContactFinder::ContactFinder(std::span<const Vec3> rest, std::vector<Triangle> closed,
                             std::vector<Triangle> touchable, double reach, double length,
                             std::span<const int> held, double room)
    : closed_(std::move(closed)),
      triangles_(std::move(touchable)),
      held_(held.begin(), held.end()),
      bvh_(rest, triangles_),
      slot_of_vertex_(rest.size(), -1) {
  for (const Vec3& p : rest) {
    int near = 0;
    for (const int i : bvh_.near(box_around(p, p, reach))) {
      const Triangle& t = triangles_[i];
      near += may_reach(rest[t[0]], rest[t[1]], rest[t[2]], p, p, reach);
    }
    max_triangles_ = std::max(max_triangles_, near);
  }
  note_openings();
  note_beyond();
  const int all = room > kUsualRoom ? std::numeric_limits<int>::max() : static_cast<int>(triangles_.size());
  // An axis may lie along a part as dense as that, but hardly all of it.
  const double balls = std::min(kMostBalls, 1 + length / (2 * reach));
  max_triangles_ = std::min(all, 8 + static_cast<int>(room * balls * max_triangles_));
  max_nodes_ = std::min(static_cast<int>(rest.size()), max_triangles_ + 2);
  vertices_.reserve(static_cast<std::size_t>(max_nodes_));
}

void ContactFinder::note_openings() {
  const auto is_held = [&](int vertex) { return std::ranges::binary_search(held_, vertex); };
  opens_.clear();
  for (const Triangle& t : triangles_) opens_.push_back(std::ranges::all_of(t, is_held) ? 0 : 1);
  if (std::ranges::count(opens_, 1) == 0) opens_.assign(triangles_.size(), 1);
}

void ContactFinder::change_surface(std::span<const Vec3> rest, std::vector<Triangle> closed,
                                   std::vector<Triangle> touchable) {
  bvh_.change(rest, triangles_, touchable);
  of_gather_ = false;
  closed_ = std::move(closed);
  triangles_ = std::move(touchable);
  note_openings();
  note_beyond();
}

void ContactFinder::note_beyond() {
  beyond_.clear();
  if (triangles_.size() == closed_.size()) return;
  std::vector<Triangle> touchable = triangles_;
  std::ranges::sort(touchable);
  for (const Triangle& t : closed_) {
    if (!std::ranges::binary_search(touchable, t)) beyond_.push_back(t);
  }
}

void ContactFinder::fit(std::span<const Vec3> positions) const noexcept {
  bvh_.refit(positions);
  of_gather_ = false;
}

int ContactFinder::slot_of(int vertex) noexcept {
  int& slot = slot_of_vertex_[vertex];
  if (slot < 0 && static_cast<int>(vertices_.size()) < max_nodes_) {
    slot = static_cast<int>(vertices_.size());
    vertices_.push_back(vertex);
  }
  return slot;
}

bool ContactFinder::try_gather(std::span<const Vec3> positions, const Vec3& p, const Vec3& q, double reach,
                               ContactPatch& patch) noexcept {
  patch.triangles.clear();
  vertices_.clear();
  bool fits = true;
  for (const int near : bvh_.near(box_around(p, q, reach))) {
    const Triangle& t = triangles_[near];
    const Vec3 &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
    if (!may_reach(a, b, c, p, q, reach) || !reaches(a, b, c, p, q, reach)) continue;
    fits = add(t, patch);
    if (!fits) break;
  }
  for (const int vertex : vertices_) slot_of_vertex_[vertex] = -1;
  return fits;
}

/// Puts a triangle into the patch. Returns false if it does not fit.
bool ContactFinder::add(const Triangle& triangle, ContactPatch& patch) noexcept {
  Triangle local;
  for (int i = 0; i < 3; ++i) local[i] = slot_of(triangle[i]);
  const bool fits =
      static_cast<int>(patch.triangles.size()) < max_triangles_ && *std::ranges::min_element(local) >= 0;
  if (fits) patch.triangles.push_back(local);
  return fits;
}

void ContactFinder::take(std::span<const Triangle> triangles, ContactPatch& patch) noexcept {
  patch.triangles.clear();
  vertices_.clear();
  for (const Triangle& t : triangles) add(t, patch);
  for (const int vertex : vertices_) slot_of_vertex_[vertex] = -1;
}

/// Adds, of those between `reach` and `more` away, for all of which there is no room, the nearest, and of
/// equally far ones the first: a long axis is as far from all that it lies on.
void ContactFinder::add_some(std::span<const Vec3> positions, const Vec3& p, const Vec3& q, double reach,
                             double more, ContactPatch& patch) noexcept {
  for (int halved = 0; halved < 12; ++halved) {
    const double middle = 0.5 * (std::max(reach, 0.0) + more);
    (try_gather(positions, p, q, middle, patch) ? reach : more) = middle;
  }
  try_gather(positions, p, q, reach, patch);
  for (std::size_t i = 0; i < vertices_.size(); ++i) slot_of_vertex_[vertices_[i]] = static_cast<int>(i);
  for (const int near : bvh_.near(box_around(p, q, more))) {
    if (static_cast<int>(patch.triangles.size()) >= max_triangles_) break;
    const Triangle& t = triangles_[near];
    const Vec3 &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
    if (!reaches(a, b, c, p, q, more) || reaches(a, b, c, p, q, reach)) continue;
    Triangle local;
    for (int i = 0; i < 3; ++i) local[i] = slot_of(t[i]);
    if (*std::ranges::min_element(local) >= 0) patch.triangles.push_back(local);
  }
  for (const int vertex : vertices_) slot_of_vertex_[vertex] = -1;
}

void ContactFinder::gather(std::span<const Vec3> positions, std::span<const Vec3> free, const Vec3& p,
                           const Vec3& q, double reach, ContactPatch& patch,
                           std::span<const int> moved) noexcept {
  of_gather_ && !moved.empty() ? bvh_.refit(positions, moved) : bvh_.refit(positions);
  of_gather_ = true;
  double more = reach;  // of which there is no room for all
  while (!try_gather(positions, p, q, reach, patch)) {
    more = reach;
    reach = reach > kNothing ? 0.9 * reach : -1;
  }
  if (reach < more && 2 * static_cast<int>(patch.triangles.size()) < max_triangles_)
    add_some(positions, p, q, reach, more, patch);
  patch.free.clear();
  for (const int vertex : vertices_) patch.free.push_back(free[vertex]);
}

bool ContactFinder::inside(std::span<const Vec3> positions, const Vec3& p) const noexcept {
  const Vec3 beside = p + kBesideEdges;
  int winding = 0;
  for (const Triangle& t : closed_)
    winding += crossing(positions[t[0]], positions[t[1]], positions[t[2]], beside);
  return winding > 0;
}

Vec3 ContactFinder::Foot::of(std::span<const Vec3> at_vertices) const noexcept {
  const Vec3 &a = at_vertices[triangle[0]], &b = at_vertices[triangle[1]], &c = at_vertices[triangle[2]];
  return weight[0] * a + weight[1] * b + weight[2] * c;
}

double ContactFinder::depth_beyond(std::span<const Vec3> positions, const Vec3& p, const Vec3& q,
                                   double radius) const noexcept {
  if (beyond_.empty()) return 0;
  const bool is_inside = inside(positions, p);
  double nearest = is_inside ? std::numeric_limits<double>::max() : radius;
  for (const Triangle& t : beyond_) {
    const Vec3 &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
    if (may_reach(a, b, c, p, q, nearest))
      nearest = std::min(nearest, nearest_on_segment(p, q, a, b, c).distance);
  }
  return is_inside ? radius + nearest : radius - nearest;
}

ContactFinder::Foot ContactFinder::closest_on(int triangle, std::span<const Vec3> positions,
                                              const Vec3& p) const noexcept {
  const Triangle& t = triangles_[triangle];
  const auto w = closest_point(p, positions[t[0]], positions[t[1]], positions[t[2]]).weight;
  return {t, {w[0], w[1], w[2]}};
}

ContactFinder::Foot ContactFinder::foot(std::span<const Vec3> positions, const Vec3& p) const noexcept {
  fit(positions);
  const int i = bvh_.nearest(box_around(p, p, 0), [&](int k) {
    return (p - closest_on(k, positions, p).of(positions)).squaredNorm();
  });
  return i < 0 ? Foot{} : closest_on(i, positions, p);
}

Vec3 ContactFinder::entry(std::span<const Vec3> positions, const Vec3& p) const noexcept {
  fit(positions);
  const int i = bvh_.nearest(box_around(p, p, 0), [&](int k) {
    return opens_[k] ? (p - closest_on(k, positions, p).of(positions)).squaredNorm()
                     : std::numeric_limits<double>::max();
  });
  return i < 0 ? p : closest_on(i, positions, p).of(positions);
}

NearestOnSegment ContactFinder::nearest(std::span<const Vec3> positions, const Vec3& p,
                                        const Vec3& q) const noexcept {
  const auto of = [&](int i) {
    const Triangle& t = triangles_[i];
    return nearest_on_segment(p, q, positions[t[0]], positions[t[1]], positions[t[2]]);
  };
  fit(positions);
  const int i = bvh_.nearest(box_around(p, q, 0), [&](int k) {
    const double distance = of(k).distance;
    return distance * distance;
  });
  return i < 0 ? NearestOnSegment{std::numeric_limits<double>::max(), 0, p} : of(i);
}

int ContactFinder::nearest_vertex(std::span<const Vec3> positions, const Vec3& p) const noexcept {
  const auto closer = [&](int a, int b) {
    return (positions[a] - p).squaredNorm() < (positions[b] - p).squaredNorm();
  };
  const auto corner = [&](int i) { return *std::ranges::min_element(triangles_[i], closer); };
  fit(positions);
  const int i =
      bvh_.nearest(box_around(p, p, 0), [&](int k) { return (positions[corner(k)] - p).squaredNorm(); });
  return i < 0 ? -1 : corner(i);
}

}  // namespace palpate::sim
