#pragma once
#include <span>
#include <vector>

#include "common/contact/contact_solver.h"
#include "common/contact/simplex_distance.h"
#include "sim_server/contact/bvh.h"

namespace palpate::sim {

/// Finds the piece of the organ's surface near a tool. Positions are those of the surface vertices, m, world.
/// Nothing but the constructor and `change_surface` allocates. One thread.
class ContactFinder {
 public:
  /// `rest`: surface vertices at rest. `closed`: all triangles of the surface, `touchable`: those the tool
  /// may touch. `reach`, `length`: the largest distance and axis that `gather` will be asked for, m; the room
  /// it needs is sized by the densest such ball at rest, for an axis by as many of them as it is long, with
  /// some to spare: `room` times it. `held`: surface vertices that are held to something, ascending.
  ContactFinder(std::span<const Vec3> rest, std::vector<Triangle> closed, std::vector<Triangle> touchable,
                double reach, double length = 0, std::span<const int> held = {}, double room = kUsualRoom);
  static constexpr double kUsualRoom = 1.5;  ///< for a surface that deforms
  static constexpr double kRoomOfCuts = 3;   ///< for one that cuts make denser than at rest, too

  /// Replaces the triangles, of the same vertices. O(n), once in some hundred triangles that are new O(n
  /// log^2 n).
  void change_surface(std::span<const Vec3> rest, std::vector<Triangle> closed,
                      std::vector<Triangle> touchable);

  std::span<const Triangle> touchable() const { return triangles_; }
  int max_nodes() const { return max_nodes_; }
  int max_triangles() const { return max_triangles_; }

  /// Puts the triangles of `positions` within `reach` of the axis from `p` to `q` (the same: a point) into
  /// the patch, with their `free` positions, and lists the surface vertex of each patch node in `vertices()`.
  /// Where there are more than fit, the nearest stay. `moved`: since the last `gather`, none but these may
  /// have moved; none: any may. O(those, or all vertices), to fit the boxes; a few triangles are looked at.
  void gather(std::span<const Vec3> positions, std::span<const Vec3> free, const Vec3& p, const Vec3& q,
              double reach, ContactPatch& patch, std::span<const int> moved = {}) noexcept;
  std::span<const int> vertices() const { return vertices_; }
  /// Puts these triangles of the surface into the patch instead, as many as fit.
  void take(std::span<const Triangle> triangles, ContactPatch& patch) noexcept;

  /// True if `p` lies inside the closed surface: its winding number, which counts the sheets that the ray
  /// along x leaves, less those that it enters. O(triangles), of which a few are looked at.
  bool inside(std::span<const Vec3> positions, const Vec3& p) const noexcept;

  /// Returns how deep a tool with this axis and radius (m) is in the surface that it may not touch, m; 0: it
  /// does not meet it. O(triangles), of which a few are looked at; nothing where it may touch all.
  double depth_beyond(std::span<const Vec3> positions, const Vec3& p, const Vec3& q,
                      double radius) const noexcept;

  /// A point of the surface, on one of its triangles.
  struct Foot {
    Triangle triangle{};
    std::array<double, 3> weight{};  ///< of its corners, sum 1; all 0: there is no surface
    Vec3 of(std::span<const Vec3> at_vertices) const noexcept;
  };
  /// The touchable one nearest to `p`. O(vertices).
  Foot foot(std::span<const Vec3> positions, const Vec3& p) const noexcept;
  /// Its place, m.
  Vec3 nearest(std::span<const Vec3> positions, const Vec3& p) const noexcept {
    return foot(positions, p).of(positions);
  }
  /// Returns where a tool that is inside, at `p`, is taken to have entered: the nearest touchable point that
  /// is not fixed, as something else lies behind a fixed surface; of all touchable points, if all are fixed.
  /// O(vertices).
  Vec3 entry(std::span<const Vec3> positions, const Vec3& p) const noexcept;
  /// Returns the closest points of the axis from `p` to `q` and the touchable surface. O(vertices).
  NearestOnSegment nearest(std::span<const Vec3> positions, const Vec3& p, const Vec3& q) const noexcept;
  /// The corner of touchable triangles nearest to `p`; -1: there is none. O(vertices).
  int nearest_vertex(std::span<const Vec3> positions, const Vec3& p) const noexcept;

 private:
  /// Patch node of a surface vertex, given one if it has none yet; -1 when there is no room.
  int slot_of(int vertex) noexcept;
  bool add(const Triangle& triangle, ContactPatch& patch) noexcept;
  bool try_gather(std::span<const Vec3> positions, const Vec3& p, const Vec3& q, double reach,
                  ContactPatch& patch) noexcept;

  void add_some(std::span<const Vec3> positions, const Vec3& p, const Vec3& q, double reach, double more,
                ContactPatch& patch) noexcept;

  Foot closest_on(int triangle, std::span<const Vec3> positions, const Vec3& p) const noexcept;

  void note_openings();
  void note_beyond();
  void fit(std::span<const Vec3> positions) const noexcept;

  std::vector<Triangle> closed_, triangles_, beyond_;  // all; those that it may touch, and may not
  std::vector<int> held_;
  std::vector<char> opens_;  // of triangles_: whether a tool can come in there
  mutable Bvh bvh_;  // of triangles_; fitted anew for each question, as the surface is another each time
  mutable bool of_gather_ = false;  // it is still as the last `gather` fitted it
  std::vector<int> vertices_, slot_of_vertex_;
  int max_nodes_ = 0, max_triangles_ = 0;
};

}  // namespace palpate::sim
