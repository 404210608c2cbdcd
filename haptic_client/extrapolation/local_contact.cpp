#include "haptic_client/extrapolation/local_contact.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kMostCorrection = 3;
// How far the model may be off at the sample, of the larger force and at all, to be believed elsewhere.
constexpr double kBelievable = 0.5, kAlways = 0.1;  // -, N

bool believable(const Vec3& local, const Vec3& right) noexcept {
  return (local - right).norm() <= kBelievable * std::max(local.norm(), right.norm()) + kAlways;
}
}  // namespace

void LocalContact::update(const Sample& sample) noexcept {
  without_.update(sample);
  if (!usable(sample) || (newest_.number > 0 && sample.t <= newest_.t)) return;
  newest_ = sample;
  known_ = false;
  if (!newest_.surface) return;
  const auto local = contact_.probe(*newest_.surface, at_rest(sample.p, sample.t));
  known_ = local && believable(*local, sample.f);
  if (known_) compare(*local);
}

void LocalContact::compare(const Vec3& local) noexcept {
  local_size_ = local.norm();
  across_.setZero();
  if (!(local_size_ > 0) || newest_.f.isZero(0)) return;
  kappa_ = std::clamp(newest_.f.dot(local) / local.squaredNorm(), 1 / kMostCorrection, kMostCorrection);
  across_ = newest_.f - kappa_ * local;
}

void LocalContact::restart() noexcept {
  without_.restart();
  contact_.lift();
  newest_ = {};
  known_ = false;
  kappa_ = 1;
}

Vec3 LocalContact::force(const Vec3& p, Time t) noexcept {
  if (known_) {
    const auto local = contact_.go(*newest_.surface, at_rest(p, t));
    if (local) {
      if (!(local_size_ > 0)) return kappa_ * *local;
      return kappa_ * *local + std::min(kMostCorrection, local->norm() / local_size_) * across_;
    }
    known_ = false;  // until the next sample: no going back and forth
  }
  return without_.force(p, t);
}

/// Where `p` is when the organ is at rest.
Vec3 LocalContact::at_rest(const Vec3& p, Time t) const noexcept {
  return p - newest_.surface->shift - to_seconds(t - newest_.t) * newest_.surface_v;
}

}  // namespace palpate::client
