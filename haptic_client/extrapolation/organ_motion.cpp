#include "haptic_client/extrapolation/organ_motion.h"

#include "haptic_client/extrapolation/force_estimate.h"

namespace palpate::client {
namespace {
constexpr double kSteady = 0.5;  // of a velocity
constexpr double kHardest = 20;  // m/s^2: a beating heart has about 5
}  // namespace

void OrganMotion::update(const Sample& sample) noexcept {
  const OrganMotion before = *this;
  restart();
  t_ = sample.t;
  known_ = sample.at_tool && sample.surface_v.norm() <= kFastest;
  if (!known_) return;
  v_ = sample.surface_v;
  if (sample.others) others_ = sample.others->v_W;
  const Time period = t_ - before.t_;
  if (!before.known_ || period <= Time::zero() || period > kOutage) return;
  const Vec3 faster = others_ - before.others_;
  Vec3 change = (v_ - before.v_) - faster;  // by the supports
  if (faster.norm() <= kSteady * others_.norm()) change += faster;
  const Vec3 a = change / to_seconds(period);
  if (a.norm() <= kHardest) a_ = a;
}

}  // namespace palpate::client
