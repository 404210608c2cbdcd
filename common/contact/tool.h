#pragma once
#include <cstddef>
#include <optional>

#include "common/types.h"

namespace palpate {

/// The most tools that a scene may have, and that a datagram may name: 0 to `kMaxTools` - 1.
constexpr std::size_t kMaxTools = 8;

/// The rigid thing that touches. The device moves one point of it, its tip: the centre of its ball.
///   sphere   the ball alone.
///   capsule  an axis of `length` from the tip along +z of the tool's orientation, the radius all along.
///   trocar   a laparoscopic instrument: a thinner shaft from the tip to the pivot, where it passes the body
///   wall
///            and which does not move. The device moves the tip by its three axes: two rotations about the
///            pivot, and insertion. The tip is ahead of the pivot by more than its radius, or it touches
///            nothing. What touches the shaft at x with force f acts at the tip as the force F that does
///            the same work, F . dp = f . dx: with a the axis, F = a (a . f) + s (f - a (a . f)), s = |x -
///            pivot| / |p - pivot| along the axis (a small roll about the axis does no work here, and the
///            wall carries the rest).
struct Tool {
  double radius = 0.005;  ///< m, [1e-5, 0.05]
  double friction = 0;    ///< Coulomb's coefficient mu against the tissue, [0, 10]; 0 = slips freely
  double length = 0;      ///< capsule: between the centres of its ends, m, [0, 0.5]; 0: a sphere
  struct Trocar {
    Vec3 pivot_W = Vec3::Zero();  ///< m
    double shaft_radius = 0.003;  ///< m, [1e-5, radius]
  };
  std::optional<Trocar> trocar{};

  bool is_sphere() const { return length == 0 && !trocar; }
};

/// Pose of a tool.
struct ToolPose {
  Vec3 p_W = Vec3::Zero();      ///< its tip, m
  Quat q_W = Quat::Identity();  ///< its orientation, unit; of a sphere only friction and jaws know it
  ToolPose() = default;
  /// Takes a position (m), any expression of one; without rotation by default.
  template <class Place>
  ToolPose(const Eigen::MatrixBase<Place>& p, const Quat& q = Quat::Identity()) : p_W(p), q_W(q) {}
};

/// The other end of the axis: the tip itself for a sphere.
inline Vec3 far_end(const Tool& tool, const ToolPose& pose) {
  if (tool.trocar) return tool.trocar->pivot_W;
  return tool.length > 0 ? Vec3(pose.p_W + tool.length * (pose.q_W * Vec3::UnitZ())) : pose.p_W;
}

}  // namespace palpate
