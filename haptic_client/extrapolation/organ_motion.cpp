#include "haptic_client/extrapolation/organ_motion.h"

#include "haptic_client/extrapolation/force_estimate.h"

namespace palpate::client {
namespace {
constexpr double kFastest = 10;  // m/s
constexpr double kHardest = 20;  // m/s^2: a beating heart has about 5
}  // namespace

void OrganMotion::update(const Sample& sample) noexcept {
  const OrganMotion before = *this;
  restart();
  t_ = sample.t;
  known_ = sample.here && sample.surface_v.norm() <= kFastest;
  if (!known_) return;
  v_ = sample.surface_v;
  const Time period = t_ - before.t_;
  if (!before.known_ || period <= Time::zero() || period > kOutage) return;
  const Vec3 a = (v_ - before.v_) / to_seconds(period);
  if (a.norm() <= kHardest) a_ = a;
}

}  // namespace palpate::client
