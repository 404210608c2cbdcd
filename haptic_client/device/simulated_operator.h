#pragma once
#include <optional>

#include "common/trajectory.h"
#include "haptic_client/device/device.h"
#include "haptic_client/device/simulated_hand.h"

namespace palpate::client {

/// A device made of a person: a hand whose arm follows a trajectory, turns the tool exactly as that does, and
/// presses the buttons that it names.
/// Deterministic: its state depends only on the times of `read` and the forces of `write`.
class SimulatedOperator : public Device {
 public:
  SimulatedOperator(const OperatorSettings& settings, Trajectory trajectory);
  /// Advances the hand to `now` in sub-steps of at most 0.25 ms (semi-implicit Euler). After a pause of more
  /// than 0.1 s the hand is taken to have paused too.
  DeviceReading read(Time now) noexcept override;
  void write(const Vec3& f_D) noexcept override;

 private:
  void advance(double dt) noexcept;

  SimulatedHand hand_;
  Trajectory trajectory_;
  std::optional<Time> last_;
  double hand_time_ = 0;  // s along the trajectory
};

}  // namespace palpate::client
