#pragma once
/// Settings of a scene for tissue that is cut.
#include <optional>
#include <string>
#include <vector>

#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/scene/regions.h"

namespace palpate::sim {

/// `[cutting.plan]`: the plane that the operator means to cut along.
struct CutPlan {
  Vec3 point;                      ///< on it, m, world
  Vec3 normal;                     ///< unit
  std::optional<double> within{};  ///< m, (0, 1]: what is farther from it cannot be cut; none: it can
  /// Signed, along the normal, m.
  double distance(const Vec3& x) const { return (x - point).dot(normal); }
};

/// `[cutting]`: tools with `cut_buttons` remove tissue by heat, or part it by their `blade`, while one of
/// these is pressed.
struct Cutting {
  double power = 40;      ///< W into the tissue at the tip, (0, 1e6]
  double energy = 2.6e9;  ///< J/m^3 that make it vanish, [1e3, 1e12]: of water, from 37 C to vapour
  double spot = 1e-3;     ///< m from the tip's surface that heat goes, [1e-6, 0.05]
  /// J/m^2 that a blade has to do for what it parts, [0, 1e5]: of bovine liver 164 (Gokgol, Basdogan and
  /// Canadinc 2012).
  double toughness = 164;
  /// m^3, [0, 1]: pieces that come loose and are smaller go; larger ones stay, free to move.
  double smallest_piece = 1e-6;
  std::optional<Region> region{};  ///< what can be cut; none: all, or what `plan` says
  std::optional<CutPlan> plan{};
  std::string where{};  ///< "FILE:LINE" of this section
};

/// Returns 1 for each tetrahedron that can be cut, else 0: those whose centre is in the box or ball and near
/// enough to the plan, or of a surface tag those with a vertex on that. Throws `Error` where none can.
std::vector<char> removable_tetrahedra(const Cutting& cutting, const TetMesh& mesh);

}  // namespace palpate::sim
