#pragma once
#include <array>
#include <utility>

#include "tests/emulation/vec.h"

namespace palpate::emulation {

/// The three legs of the Falcon (a delta after Stamper), by the equations of their links, solved with
/// Newton's method. Device frame: origin between the motors, x right, y up, z out towards the user; metres,
/// radians. Written from the drawing alone: it must not share an error with the client's kinematics.
class DeltaMechanism {
 public:
  /// The joints of a leg: thigh against the base, parallelogram in the leg's plane, and out of that plane.
  struct Leg {
    double thigh = 0.3, shin = 2.3, side = 1.6;
  };
  DeltaMechanism();

  /// Moves the grip to `position`. Returns false, and stays where it was, if the links do not reach.
  bool move_to(const Vec& position);
  const Vec& position() const { return position_; }
  const std::array<Leg, 3>& legs() const { return legs_; }
  double thigh(int leg) const { return legs_[static_cast<std::size_t>(leg)].thigh; }

  /// Row i: d thigh_i / d position (rad/m), by central differences of 1 um. Zero rows where the links end.
  std::array<Vec, 3> jacobian() const;
  /// Force on the grip (N) from torques on the thighs (N m), by virtual work.
  static Vec force(const std::array<Vec, 3>& jacobian, const std::array<double, 3>& torque);

  /// How far the links fail to meet (m), over all legs: about 0 after a `move_to`.
  double residual() const;

 private:
  Vec position_;
  std::array<Leg, 3> legs_;
};

}  // namespace palpate::emulation
