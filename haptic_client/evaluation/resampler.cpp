#include "haptic_client/evaluation/resampler.h"

#include <utility>

namespace palpate::client {

bool Resampler::pass() {
  before_ = after_;
  if (before_ && before_->arrived) arrived_ = before_->arrived;
  CapturedTick tick;
  after_ = session_.next(tick) ? std::optional(tick) : std::nullopt;
  return before_.has_value();
}

bool Resampler::next(CapturedTick& out) {
  if (k_ == 0) {
    pass();
    if (!pass()) return false;
    start_ = Time{before_->state.t_ns};
  }
  const Time t = start_ + from_seconds(static_cast<double>(k_) / rate_hz_);
  while (after_ && Time{after_->state.t_ns} <= t) pass();
  const protocol::ToolState& a = before_->state;
  if (!after_ && t.count() > a.t_ns) return false;
  const protocol::ToolState& b = after_ ? after_->state : a;
  const double share =
      after_ ? static_cast<double>(t.count() - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns) : 0;
  out.state = a;
  out.state.tick = ++k_;
  out.state.t_ns = t.count();
  out.state.p_W = a.p_W + share * (b.p_W - a.p_W);
  out.state.v_W = a.v_W + share * (b.v_W - a.v_W);
  out.arrived = std::exchange(arrived_, std::nullopt);
  return true;
}

}  // namespace palpate::client
