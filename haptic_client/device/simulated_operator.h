#pragma once
#include <optional>

#include "common/trajectory.h"
#include "haptic_client/device/device.h"

namespace palpate::client {

/// A hand on a handle. Defaults: the "typical" operator, 0.3 kg, 2 N s/m in the device, 300 N/m and 10 N s/m
/// in the arm.
struct OperatorSettings {
  double mass = 0.3;            ///< of hand and handle, kg, [0.01, 10]
  double device_damping = 2;    ///< friction of the device, N s/m, [0, 100]
  double hand_stiffness = 300;  ///< of the arm towards where it wants to be, N/m, [0, 1e5]
  double hand_damping = 10;     ///< N s/m, [0, 1e3]
  double max_force = 8;         ///< what the simulated motors give, N, (0, 100]
};

/// A device made of a person: a mass pulled by a spring and a damper towards a moving target (the
/// trajectory), pushed by the motors. Deterministic: its state depends only on the times of `read` and the
/// forces of `write`.
class SimulatedOperator : public Device {
 public:
  SimulatedOperator(const OperatorSettings& settings, Trajectory trajectory);
  /// Advances the hand to `now` in sub-steps of at most 0.25 ms (semi-implicit Euler). After a pause of more
  /// than 0.1 s the hand is taken to have paused too.
  DeviceReading read(Time now) noexcept override;
  void write(const Vec3& f_D) noexcept override;

 private:
  void advance(double dt) noexcept;

  OperatorSettings settings_;
  Trajectory trajectory_;
  std::optional<Time> last_;
  double hand_time_ = 0;  // s along the trajectory
  Vec3 p_, v_ = Vec3::Zero(), force_ = Vec3::Zero();
};

}  // namespace palpate::client
