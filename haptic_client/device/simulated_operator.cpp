#include "haptic_client/device/simulated_operator.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {
namespace {
constexpr double kSubStep = 0.25e-3;  // s: w dt = 0.1 for 5 kN/m on 30 g, well inside stability
constexpr double kLongest = 0.1;      // s
}  // namespace

SimulatedOperator::SimulatedOperator(const OperatorSettings& settings, Trajectory trajectory)
    : settings_(settings), trajectory_(std::move(trajectory)), p_(trajectory_.at(0)) {}

DeviceReading SimulatedOperator::read(Time now) noexcept {
  const double dt = last_ ? std::clamp(to_seconds(now - *last_), 0.0, kLongest) : 0;
  last_ = now;
  const int steps = static_cast<int>(std::ceil(dt / kSubStep));
  for (int i = 0; i < steps; ++i) advance(dt / steps);
  return {.t = now, .p_D = p_};
}

void SimulatedOperator::advance(double dt) noexcept {
  const Vec3 target = trajectory_.at(hand_time_ + dt);
  const Vec3 target_velocity = (target - trajectory_.at(hand_time_)) / dt;
  hand_time_ += dt;
  const Vec3 arm = settings_.hand_stiffness * (target - p_) + settings_.hand_damping * (target_velocity - v_);
  v_ += dt / settings_.mass * (arm + force_ - settings_.device_damping * v_);
  p_ += dt * v_;
}

void SimulatedOperator::write(const Vec3& f_D) noexcept {
  force_ = f_D;
}

}  // namespace palpate::client
