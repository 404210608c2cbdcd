#pragma once
#include "sim_server/elasticity/solid.h"

namespace palpate::sim {

/// True if a tetrahedron of `solid` that is no sliver is inside out (by its corners) at positions `x` (nodes,
/// m). Flat tetrahedra turn over under small loads, without effect on the force. O(elements), a fraction of
/// `Solid::forces`.
bool any_inverted(const Solid& solid, std::span<const Vec3> x);

/// True if tissue of this material can have a second equilibrium inside out: St. Venant and Kirchhoff's, and
/// corotational tissue where nu is near one half.
bool may_stay_inverted(const Material& material);

}  // namespace palpate::sim
