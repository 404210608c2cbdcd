#include "haptic_client/extrapolation/linear_time.h"

namespace palpate::client {

Vec3 LinearTime::force(const Vec3&, Time t) const noexcept {
  const auto& [newest, before, count] = samples_;
  const Time period = newest.t - before.t;
  if (count < 2 || period <= Time::zero()) return newest.f;
  return newest.f + to_seconds(t - newest.t) / to_seconds(period) * (newest.f - before.f);
}

}  // namespace palpate::client
