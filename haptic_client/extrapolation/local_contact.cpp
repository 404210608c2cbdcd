#include "haptic_client/extrapolation/local_contact.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kMostCorrection = 3;
}

void LocalContact::update(const Sample& sample) noexcept {
  without_.update(sample);
  if (!usable(sample) || (newest_.number > 0 && sample.t <= newest_.t)) return;
  newest_ = sample;
  known_ = false;
  if (!newest_.surface) return;
  const auto local = contact_.probe(*newest_.surface, at_rest(sample.p, sample.t));
  known_ = local.has_value();
  if (known_) local_ = *local;
}

void LocalContact::restart() noexcept {
  without_.restart();
  contact_.lift();
  newest_ = {};
  known_ = false;
}

Vec3 LocalContact::force(const Vec3& p, Time t) noexcept {
  if (known_) {
    const auto local = contact_.go(*newest_.surface, at_rest(p, t));
    if (local) {
      const double size = local_.norm();
      const double share = size > 0 ? std::min(kMostCorrection, local->norm() / size) : 0;
      return *local + share * (newest_.f - local_);
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
