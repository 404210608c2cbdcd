#pragma once
#include "sim_server/elasticity/solid.h"

namespace palpate::sim {

/// Whether a tetrahedron of `solid` is inside out (by its corners) at positions `x` (nodes, m) that is no
/// sliver: flat ones turn over under little, and are not felt when they do. O(elements), a fraction of
/// `Solid::forces`.
bool any_inverted(const Solid& solid, std::span<const Vec3> x);

/// Whether tissue of this material can have a second rest inside out: St. Venant and Kirchhoff's, and
/// corotational tissue where nu is near one half.
bool may_stay_inverted(const Material& material);

}  // namespace palpate::sim
