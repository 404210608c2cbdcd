#include "haptic_client/evaluation/captured_hand.h"

namespace palpate::client {
using protocol::ToolState;

CapturedHand::CapturedHand(CapturedSession& session) {
  for (CapturedTick tick; session.next(tick);) {
    const ToolState& state = tick.state;
    ticks_.push_back(
        {Time{state.t_ns}, state.p_W, state.buttons, (state.flags & ToolState::kDeviceLost) != 0});
  }
}

double CapturedHand::seconds() const {
  return ticks_.empty() ? 0 : to_seconds(ticks_.back().t - ticks_.front().t);
}

DeviceReading CapturedHand::read(Time now) noexcept {
  if (ticks_.empty()) return {.t = now, .valid = false};
  if (start_ == Time{}) start_ = now;
  const Time t = ticks_.front().t + (now - start_);
  while (at_ + 1 < ticks_.size() && ticks_[at_ + 1].t <= t) ++at_;
  const Tick& tick = ticks_[at_];
  DeviceReading reading{.t = now, .p_D = tick.p_W, .buttons = tick.buttons, .valid = !tick.lost};
  if (at_ + 1 == ticks_.size() || ticks_[at_ + 1].lost) return reading;
  const Tick& next = ticks_[at_ + 1];
  reading.p_D += to_seconds(t - tick.t) / to_seconds(next.t - tick.t) * (next.p_W - tick.p_W);
  return reading;
}

}  // namespace palpate::client
