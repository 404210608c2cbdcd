#pragma once
#include <array>
#include <span>
#include <vector>

#include "common/types.h"

namespace palpate {

/// One place where the tool could touch: the point of a face, an edge or a vertex closest to its centre.
struct Contact {
  std::array<int, 3> node;       ///< patch nodes of the feature, ascending; unused entries -1
  std::array<double, 3> weight;  ///< how much of the contact point each node carries; sum 1
  int size;                      ///< 1 vertex, 2 edge, 3 face
  Vec3 normal;                   ///< unit, from the surface to the tool centre
  double distance;               ///< from the surface to the tool centre, m, >= 0
};

/// Finds the features of `triangles` (corners index `x`, positions in m) within `reach` of the point `p`, one
/// contact per feature, in the order of the triangles. One contact per triangle, merged where triangles share
/// the feature, is what makes the force continuous: each closest point is the projection on a convex set.
/// Writes into `contacts`, which must have room for one per triangle (its capacity is not grown). Distances
/// are unsigned: the caller sees to it that the centre stays on the outside (see ContactSolver). O(triangles
/// + contacts^2).
void find_contacts_on_patch(std::span<const Vec3> x, std::span<const std::array<int, 3>> triangles,
                            const Vec3& p, double reach, std::vector<Contact>& contacts) noexcept;

}  // namespace palpate
