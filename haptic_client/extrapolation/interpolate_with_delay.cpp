#include "haptic_client/extrapolation/interpolate_with_delay.h"

#include <algorithm>

namespace palpate::client {

void InterpolateWithDelay::update(const Sample& sample) noexcept {
  if (!usable(sample) || (count_ > 0 && sample.t <= samples_[0].t)) return;
  std::move_backward(samples_.begin(), samples_.end() - 1, samples_.end());
  samples_[0] = sample;
  count_ = std::min(count_ + 1, kDepth);
}

Vec3 InterpolateWithDelay::force(const Vec3&, Time t) noexcept {
  if (count_ == 0) return Vec3::Zero();
  if (count_ < kDepth) return samples_[0].f;
  const Time then = t - 2 * (samples_[0].t - samples_[1].t);
  if (then >= samples_[0].t) return samples_[0].f;
  for (std::size_t i = 1; i < kDepth; ++i) {
    const Sample &after = samples_[i - 1], &before = samples_[i];
    if (then < before.t) continue;
    const double fraction = to_seconds(then - before.t) / to_seconds(after.t - before.t);
    return before.f + fraction * (after.f - before.f);
  }
  return samples_[kDepth - 1].f;
}

}  // namespace palpate::client
