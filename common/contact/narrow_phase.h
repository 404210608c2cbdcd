#pragma once
#include <array>
#include <span>
#include <vector>

#include "common/contact/tool.h"

namespace palpate {

/// Possible contact with the tool: a face, an edge or a vertex, and the point of the tool's axis closest to
/// it.
struct Contact {
  std::array<int, 3> node;       ///< patch nodes of the feature, ascending; unused entries -1
  std::array<double, 3> weight;  ///< how much of the contact point each node carries; sum 1
  int size;                      ///< 1 vertex, 2 edge, 3 face
  enum Part { kTip, kFarEnd, kShaft } part;
  Vec3 normal;      ///< unit, from the surface to the axis
  double distance;  ///< from the surface to the axis, m, >= 0
  double radius;    ///< of the tool there, m
  Vec3 arm;         ///< from the tool's tip to the surface there, m
  Vec3 axis;        ///< of the shaft: from the pivot to the tip, or of unit length; else 0
  double
      fraction;  ///< how much a sideways motion of the tip moves the tool there: below 1 on a pivoting shaft
  int tool = 0;  ///< which of those that are solved for
  double friction = 0;  ///< Coulomb's coefficient

  /// A force f on the tool here, as the force at its tip that does the same work (Tool); and M^T f for M
  /// which takes a small motion of the tip to that of the tool here.
  Vec3 at_tip(const Vec3& f) const {
    return fraction == 1 ? f : Vec3(fraction * f + (1 - fraction) * axis.dot(f) / axis.squaredNorm() * axis);
  }
};

/// Finds the features of `triangles` (corners index `x`, positions in m) whose distance to the tool's surface
/// is at most `margin`, one contact per feature and part of the tool, in the order of the triangles. One
/// contact per triangle, merged where triangles share the feature, is what makes the force continuous: each
/// closest point is the projection on a convex set. An axis touches triangles with its ends, as spheres do,
/// and edges with what lies between its ends: no closest pair of axis and face is ever lost, though an axis
/// parallel to a face has many; only along an edge parallel to it does a contact jump, and then the place and
/// not the normal. Appends to `contacts` as many as it has room for (its capacity is not grown), and returns
/// false if there are more. Distances are unsigned: the caller sees to it that the axis stays on the outside
/// (see ContactSolver). O(triangles + contacts^2).
bool find_contacts_on_patch(std::span<const Vec3> x, std::span<const std::array<int, 3>> triangles,
                            const Tool& tool, const ToolPose& pose, double margin,
                            std::vector<Contact>& contacts) noexcept;

}  // namespace palpate
