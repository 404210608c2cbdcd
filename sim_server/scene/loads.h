#pragma once
#include <span>
#include <vector>

#include "sim_server/elasticity/solid.h"
#include "sim_server/mesh/surface.h"
#include "sim_server/scene/held_motion.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// Loads and supports on a body by the [[load]] and [[fixed]] sections of a scene.
class Loads {
 public:
  /// Throws `Error` for a region that holds nothing, or a load on vertices that are all fixed.
  Loads(const Scene& scene, const TetMesh& mesh, const Surface& surface, const Solid& solid);

  /// Adds the forces (nodes, N) on a body at `x` (nodes, m).
  void add_forces(std::span<const Vec3> x, std::span<Vec3> f) const;
  /// (nodes) One in the middle of an edge is held where both ends are.
  const std::vector<HeldAxes>& held() const { return held_; }
  /// (nodes) From rest to where they are held at time `t` (s), m; empty where all are always held at rest.
  /// What [[fixed.motion]] does adds to a displacement.
  std::vector<Vec3> moved(double t = 0) const;
  /// Puts what is held of a body at `x` (nodes, m) there. No allocation.
  void put_held(double t, std::span<Vec3> x) const noexcept;
  const std::vector<HeldMotion>& motions() const { return motions_; }

 private:
  struct Face {
    Triangle corners;
    Triangle pushed;  // nodes that share the force on it equally
  };
  struct Pressure {
    double pascal;
    std::vector<Face> faces;
  };
  void hold(const Scene& scene, const TetMesh& mesh);
  static std::vector<Face> faces_in(const Region& region, const TetMesh& mesh, const Surface& surface);
  /// Throws `Error` where all of them are held.
  std::vector<Face> movable_faces_in(const Region& region, const TetMesh& mesh, const Surface& surface) const;
  static void push(const Face& face, const Vec3& force, std::span<Vec3> f);

  bool follows_ = false;           // pressure goes with the surface
  std::vector<Vec3> rest_, dead_;  // nodes at rest, m; forces that do not change, N
  std::vector<Pressure> pressures_;
  std::vector<HeldAxes> held_;
  std::vector<Vec3> moved_;  // but for motions
  std::vector<HeldMotion> motions_;
};

}  // namespace palpate::sim
