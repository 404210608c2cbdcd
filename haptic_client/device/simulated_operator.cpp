#include "haptic_client/device/simulated_operator.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {

SimulatedOperator::SimulatedOperator(const OperatorSettings& settings, Trajectory trajectory)
    : hand_(settings, trajectory.at(0)), trajectory_(std::move(trajectory)) {}

DeviceReading SimulatedOperator::read(Time now) noexcept {
  const double dt = last_ ? std::clamp(to_seconds(now - *last_), 0.0, SimulatedHand::kLongest) : 0;
  last_ = now;
  const int steps = static_cast<int>(std::ceil(dt / SimulatedHand::kSubStep));
  for (int i = 0; i < steps; ++i) advance(dt / steps);
  DeviceReading reading{.t = now, .p_D = hand_.place(), .buttons = trajectory_.buttons_at(hand_time_)};
  if (trajectory_.turns()) reading.q_D = trajectory_.orientation_at(hand_time_);
  return reading;
}

void SimulatedOperator::advance(double dt) noexcept {
  const Vec3 target = trajectory_.at(hand_time_ + dt);
  const Vec3 target_velocity = (target - trajectory_.at(hand_time_)) / dt;
  hand_time_ += dt;
  hand_.advance(target, target_velocity, dt);
}

void SimulatedOperator::write(const Vec3& f_D) noexcept {
  hand_.push(f_D);
}

}  // namespace palpate::client
