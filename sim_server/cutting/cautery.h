#pragma once
#include <span>
#include <vector>

#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/scene/cutting.h"

namespace palpate::sim {

/// A tip that is hot: its centre went straight and evenly from one place to another (m, world).
struct HotTip {
  Vec3 from_W, p_W;
  double radius;  ///< m
};

/// Heat in tissue, and which of it that makes vanish. A tip gives its power to the tetrahedra whose outer
/// faces lie within `spot` of it, more to those that are nearer and show it more: by face area times 1 - gap
/// / spot, both in the deformed body; one that went far does so along its way, in parts no longer than half
/// its radius. Heat stays where it went. A tetrahedron is gone when it has taken `energy` for its volume at
/// rest. One thread; allocates.
class Cautery {
 public:
  Cautery(const Cutting& cutting, const TetMesh& mesh);

  /// `dt` (s) of these tips on the surface at `positions` (its vertices, m). The tetrahedra that are gone by
  /// that, ascending. O(triangles) where there is a tip.
  std::vector<int> heat(std::span<const HotTip> tips, const CutMesh& mesh, const Surface& surface,
                        std::span<const Vec3> positions, double dt);
  /// Returns the heat put into tissue so far, J, whether that remains or not.
  double spent() const { return spent_; }
  /// Returns the time so far, s, in which a tip was at tissue that cannot be removed.
  double time_at_end() const { return time_at_end_; }
  std::size_t bytes() const { return 2 * taken_.size() * sizeof(double); }

 private:
  struct Exposed {
    int tetrahedron;
    double weight;  // m^2
  };
  struct Touched {
    std::vector<Exposed> exposed;
    bool end = false;  // tissue that cannot be removed, too
  };
  Touched touched_by(const Vec3& p, double radius, const CutMesh& mesh, const Surface& surface,
                     std::span<const Vec3> positions) const;
  void give(double joule, std::span<const Exposed> exposed, std::vector<int>& removed);

  double power_, spot_;                 // W, m
  std::vector<double> taken_, needed_;  // of each tetrahedron, J
  double spent_ = 0, time_at_end_ = 0;
};

}  // namespace palpate::sim
