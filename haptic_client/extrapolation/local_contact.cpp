#include "haptic_client/extrapolation/local_contact.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kMostCorrection = 3;
constexpr std::size_t kRemembered = 1024;             // ticks: a quarter of a second at 4 kHz
constexpr Time kGap = std::chrono::milliseconds(20);  // between ticks on whose line something may lie
// How far the model may be off at the sample, of the larger force and at all, to be believed elsewhere.
constexpr double kBelievable = 0.5, kAlways = 0.1;  // -, N

bool believable(const Vec3& local, const Vec3& right) noexcept {
  return (local - right).norm() <= kBelievable * std::max(local.norm(), right.norm()) + kAlways;
}
/// kappa: how many times `local` the part of `right` along it is.
double factor(const Vec3& right, const Vec3& local) noexcept {
  return std::clamp(right.dot(local) / local.squaredNorm(), 1 / kMostCorrection, kMostCorrection);
}
}  // namespace

LocalContact::LocalContact() : felt_(kRemembered) {}

void LocalContact::update(const Sample& sample) noexcept {
  without_.update(sample);
  if (!usable(sample) || (newest_.number > 0 && sample.t <= newest_.t)) return;
  newest_ = sample;
  motion_.update(sample);
  known_ = false;
  if (!newest_.surface) return;
  const bool follows_path = newest_.surface->tool.friction > 0;
  const auto local =
      follows_path ? remembered(sample.t) : contact_.probe(*newest_.surface, at_rest(sample.p, sample.t));
  if (follows_path && !local) {  // it begins to follow
    local_size_ = 0;
    known_ = true;
    return;
  }
  known_ = local && believable(*local, sample.f);
  if (!known_) return;
  compare(*local);
  if (!follows_path && local->isZero(0) && sample.f.isZero(0)) compare_ahead();
}

void LocalContact::remember(Time t, const Vec3& local) noexcept {
  if (felts_ > 0 && felt_[(felts_ - 1) % kRemembered].t >= t) return;
  felt_[felts_++ % kRemembered] = {t, local};
}

/// What was felt at `t`, or on the line between two ticks around it.
std::optional<Vec3> LocalContact::remembered(Time t) const noexcept {
  const Felt* after = nullptr;
  for (std::size_t back = 1; back <= std::min(felts_, kRemembered); ++back) {
    const Felt& felt = felt_[(felts_ - back) % kRemembered];
    if (felt.t == t) return felt.force;
    if (felt.t < t) {
      if (after == nullptr || after->t - felt.t > kGap) return {};
      const double share = to_seconds(t - felt.t) / to_seconds(after->t - felt.t);
      return felt.force + share * (after->force - felt.force);
    }
    after = &felt;
  }
  return {};
}

void LocalContact::compare(const Vec3& local) noexcept {
  local_size_ = local.norm();
  across_.setZero();
  if (!(local_size_ > 0) || newest_.f.isZero(0)) return;
  kappa_ = factor(newest_.f, local);
  across_ = newest_.f - kappa_ * local;
}

/// The tool is free, but was expected to touch by now: the server has said what it would feel.
void LocalContact::compare_ahead() noexcept {
  if (!newest_.ahead || !newest_.ahead->f.allFinite() || newest_.ahead->f.isZero(0)) return;
  const auto local = contact_.probe(*newest_.surface, at_rest(newest_.ahead->p, newest_.t));
  if (local && !local->isZero(0) && believable(*local, newest_.ahead->f))
    kappa_ = factor(newest_.ahead->f, *local);
}

void LocalContact::restart() noexcept {
  without_.restart();
  contact_.lift();
  felts_ = 0;
  newest_ = {};
  motion_.restart();
  known_ = false;
  kappa_ = 1;
}

Vec3 LocalContact::force(const Vec3& p, Time t) noexcept {
  if (known_) {
    const auto local = contact_.go(*newest_.surface, at_rest(p, t));
    if (local) {
      remember(t, *local);
      if (!(local_size_ > 0)) return kappa_ * *local;
      return kappa_ * *local + std::min(kMostCorrection, local->norm() / local_size_) * across_;
    }
    known_ = false;  // until the next sample: no going back and forth
  }
  return without_.force(p, t);
}

/// Where `p` is when the organ is at rest.
Vec3 LocalContact::at_rest(const Vec3& p, Time t) const noexcept {
  return p - newest_.surface->shift - motion_.since_sample(t);
}

}  // namespace palpate::client
