#include "haptic_client/extrapolation/linear_time.h"

namespace palpate::client {

Vec3 LinearTime::force(const Vec3&, Time t) noexcept {
  const auto& [newest, before, count] = samples_;
  if (count < 2) return newest.f;
  const Time period = newest.t - before.t;
  return newest.f + to_seconds(t - newest.t) / to_seconds(period) * (newest.f - before.f);
}

}  // namespace palpate::client
