#include "haptic_client/evaluation/resampler.h"

#include <utility>

namespace palpate::client {
namespace {
// Between two states: beyond, the motion between them is not known.
constexpr Time kGap = std::chrono::seconds(1);
}  // namespace

bool Resampler::pass() {
  before_ = after_;
  if (before_ && before_->arrived) arrived_ = before_->arrived;
  if (before_) {
    flags_ |= before_->state.flags;
    pages_.insert(pages_.end(), before_->pages.begin(), before_->pages.end());
  }
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
  Time t = start_ + from_seconds(static_cast<double>(k_ - start_k_) / rate_hz_);
  if (after_ && t < Time{after_->state.t_ns} && after_->state.t_ns - before_->state.t_ns > kGap.count()) {
    t = start_ = Time{after_->state.t_ns};
    start_k_ = k_;
  }
  while (after_ && Time{after_->state.t_ns} <= t) pass();
  const protocol::ToolState& a = before_->state;
  if (!after_ && t.count() > a.t_ns) return false;
  const protocol::ToolState& b = after_ ? after_->state : a;
  const double fraction =
      after_ ? static_cast<double>(t.count() - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns) : 0;
  out.state = a;
  // What lasts until the next tick, and what happened once.
  constexpr std::uint16_t kLasting = protocol::ToolState::kDeviceLost | protocol::ToolState::kClutched;
  out.state.flags =
      static_cast<std::uint16_t>(std::exchange(flags_, std::uint16_t{0}) | (a.flags & kLasting));
  out.state.tick = ++k_;
  out.state.t_ns = t.count();
  out.state.p_W = a.p_W + fraction * (b.p_W - a.p_W);
  out.state.v_W = a.v_W + fraction * (b.v_W - a.v_W);
  out.arrived = std::exchange(arrived_, std::nullopt);
  out.pages = std::exchange(pages_, {});
  return true;
}

}  // namespace palpate::client
