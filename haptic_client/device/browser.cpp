#include "haptic_client/device/browser.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {

DeviceReading Browser::read(Time now) noexcept {
  const double dt = last_ ? std::clamp(to_seconds(now - *last_), 0.0, SimulatedHand::kLongest) : 0;
  last_ = now;
  const int steps = static_cast<int>(std::ceil(dt / SimulatedHand::kSubStep));
  for (int i = 0; i < steps; ++i) {
    const double step = dt / steps;
    const Vec3 left = aim_ - arm_;
    const double before = arm_v_.norm() * step;  // what it would go on by
    const Vec3 go = left.norm() <= before ? left : Vec3(arm_v_ * step);
    arm_ += go;
    hand_.advance(arm_, go / step, step);
  }
  return {.t = now, .p_D = hand_.place(), .buttons = buttons_};
}

void Browser::aim(const Vec3& p_D, std::uint16_t buttons) noexcept {
  if (!p_D.allFinite()) return;
  aim_ = p_D;
  buttons_ = buttons;
  arm_v_ = (aim_ - arm_) / kBetween;
  if (arm_v_.norm() > kFastest_) arm_v_ *= kFastest_ / arm_v_.norm();
}

}  // namespace palpate::client
