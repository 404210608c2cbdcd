#pragma once
#include <array>
#include <cstdint>

#include "tests/emulation/delta_mechanism.h"
#include "tests/emulation/hand.h"

namespace palpate::emulation {

constexpr int kLargestDac = 4096;  ///< the firmware cuts motor commands here

/// Counts of an encoder whose zero is found, from the angle of a thigh (rad); not rounded.
double counts_of(double thigh);

/// Work on the grip since the start (J), each by the force named. Their sum is the kinetic energy.
struct Work {
  double hand = 0, motors = 0, friction = 0, stops = 0, weight = 0;
};

/// The Falcon's mechanism with a hand on it: a mass that the motors, the hand, friction in the joints and the
/// hard stops push. Semi-implicit Euler, steps of 0.1 ms. Device frame, SI.
class FalconMechanics {
 public:
  struct Settings {
    double torque_constant =
        10000;               ///< DAC units per N m, (0, 1e6]; not known better than within a factor of 4
    double coulomb = 0.001;  ///< N m per joint, 0 or more
    double viscous = 1e-4;   ///< N m s/rad per joint, 0 or more
    std::uint64_t seed = 1;  ///< of the encoders' zeros before homing
  };
  explicit FalconMechanics(const Settings& settings);

  Hand hand;
  double mass = 0.2;  ///< kg at the grip, hand included, [0.02, 5]; balanced: gravity does not pull at it
  double weight = 0;  ///< kg hung on the grip, [0, 2]: gravity pulls at it along -y; it moves with the grip

  /// Motor commands in DAC units; more than +-4096 is cut. Positive turns the thigh back and pulls the grip
  /// in.
  void set_dac(const std::array<int, 3>& dac);
  /// Mains: without it no torque, and no reference is found.
  void set_mains(bool on) { mains_ = on; }
  /// The firmware's homing bit; off forgets the references.
  void set_homing(bool on);
  /// All references found at once.
  void home_now();
  /// What a reset does: references lost, encoders at a random zero, motors off.
  void power_up();
  void advance(double seconds);
  /// Puts the grip there at rest, and the hand's target too; false, and nothing changed, if out of reach.
  bool place(const Vec& position);

  std::array<int, 3> encoders() const;
  /// Bit 0 top, 1 right, 2 left: the reference has been found.
  unsigned homed() const;
  const Vec& position() const { return mechanism_.position(); }
  const Vec& velocity() const { return velocity_; }
  const std::array<int, 3>& dac() const { return dac_; }
  Vec motor_force() const;
  bool mains() const { return mains_; }
  const Work& work() const { return work_; }
  double kinetic_energy() const { return (mass + weight) * dot(velocity_, velocity_) / 2; }
  double time() const { return time_; }

 private:
  struct Encoder {
    int offset = 0;
    bool pulled = false, found = false;  // went out far enough, and came back over the reference
  };
  void step(double dt);
  Vec friction_force() const;
  void look_for_references();
  std::uint64_t draw();

  Settings settings_;
  DeltaMechanism mechanism_;
  std::array<Vec, 3> jacobian_{};
  Vec velocity_;
  std::array<int, 3> dac_{};
  std::array<Encoder, 3> encoders_{};
  bool mains_ = true, homing_ = false;
  Work work_;
  double time_ = 0, rest_ = 0;  // s; `rest_` is what did not fill a step
  std::uint64_t random_;
};

}  // namespace palpate::emulation
