#include "haptic_client/extrapolation/force_estimate.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {

bool ForceEstimate::take(const Sample& sample, const Vec3& p, Time now) noexcept {
  const bool first = newest_.number == 0;
  const bool in_order = sample.t >= Time::zero() && sample.t <= now && (first || sample.t > newest_.t);
  if (!in_order || !usable(sample)) return false;
  const Vec3 before = blend_ > 0 ? force(p, now) : Vec3(Vec3::Zero());
  const bool another = !first && sample.number <= newest_.number;  // a server that begins anew counts anew
  period_ = first ? Time::zero() : sample.t - newest_.t;
  if (period_ > kOutage || another) {
    law_->restart();  // no line leads from before it to here
    period_ = Time::zero();
  } else if (!first && sample.cuts != newest_.cuts) {
    law_->surface_cut();
  }
  const Time age = std::min(now - sample.t, kOutage);
  usual_age_ = period_ > Time::zero() ? usual_age_ + (age - usual_age_) / kAgeFilter : age;
  newest_ = sample;
  law_->update(sample);
  if (blend_ > 0) blend_from(before, law_force(p, now), now);
  if (another) offset_.setZero();
  return true;
}

Vec3 ForceEstimate::force(const Vec3& p, Time t) noexcept {
  const Vec3 f = law_force(p, t);
  if (!(blend_ > 0)) return f;
  if (law_->stepped_down() != stepped_down_) blend_from(last_, f, t);
  return last_ = blended(f, t);
}

/// Adds the blend to the force of the law. It shrinks with that force from when it began: a tool that leaves
/// is free at once, comes into contact again as the law says, and no force pulls.
Vec3 ForceEstimate::blended(const Vec3& f, Time t) noexcept {
  if (f.isZero(0)) offset_.setZero();
  const double size = f.norm(), fraction = size < began_ ? size / began_ : 1;
  const Vec3 sum = f + fraction * std::exp(-to_seconds(t - changed_) / blend_) * offset_;
  const Vec3 push = f.stableNormalized();
  return sum - std::min(sum.dot(push), 0.0) * push;
}

void ForceEstimate::blend_from(const Vec3& before, const Vec3& after, Time t) noexcept {
  stepped_down_ = law_->stepped_down();
  offset_ = before - after;
  began_ = after.norm();
  changed_ = t;
}

Vec3 ForceEstimate::law_force(const Vec3& p, Time t) noexcept {
  if (newest_.f.isZero(0) && !sees_surface_) return Vec3::Zero();
  law_->start_tick(t);
  return law_->force(p, law_time(t));
}

/// Returns what a law takes for `t`. A sample alone says nothing of time.
Time ForceEstimate::law_time(Time t) const noexcept {
  if (period_ == Time::zero()) return newest_.t;
  const Time patience = std::min(usual_age_ + kPatience * period_, kOutage), age = t - newest_.t;
  return newest_.t + std::clamp(2 * patience - age, Time::zero(), std::min(age, patience));
}

}  // namespace palpate::client
