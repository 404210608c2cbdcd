#include "haptic_client/extrapolation/force_estimate.h"

namespace palpate::client {

bool ForceEstimate::take(const Sample& sample, Time now) noexcept {
  const bool first = newest_.number == 0;
  const bool in_order = sample.t >= Time::zero() && sample.t <= now && (first || sample.t > newest_.t);
  if (!in_order || !usable(sample)) return false;
  period_ = first ? Time::zero() : sample.t - newest_.t;
  if (period_ > kOutage) {
    law_->restart();  // no line leads from before it to here
    period_ = Time::zero();
  }
  newest_ = sample;
  law_->update(sample);
  return true;
}

Vec3 ForceEstimate::force(const Vec3& p, Time t) const noexcept {
  if (newest_.f.isZero(0) && !sees_surface_) return Vec3::Zero();
  return law_->force(p, t - newest_.t <= kPatience * period_ ? t : newest_.t);
}

}  // namespace palpate::client
