#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// Motion of one `[[fixed.motion]]` and the nodes it moves.
struct HeldMotion {
  SupportMotion motion;
  /// Each and its displacement per displacement of the support, no unit, along the axes on which it is held.
  std::vector<std::pair<int, Vec3>> nodes{};
  std::string where{};  ///< "FILE:LINE" of its [[fixed]]
};

/// 2 pi t / period + phase, rad; t in s.
double angle_at(const SupportMotion& motion, double t);
/// amplitude x sin of that, m.
double displacement_at(const SupportMotion& motion, double t);

/// True if any [[fixed]] of the scene has a motion.
bool supports_move(const Scene& scene);

/// Returns all motions of a scene, region by region. `held`: (vertices) of `mesh`. A corner in several
/// [[fixed]] belongs to the first; a held vertex in the middle of an edge moves by the mean of its ends.
std::vector<HeldMotion> held_motions(const Scene& scene, const TetMesh& mesh, std::span<const HeldAxes> held);

}  // namespace palpate::sim
