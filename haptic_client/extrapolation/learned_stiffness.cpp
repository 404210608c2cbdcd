#include "haptic_client/extrapolation/learned_stiffness.h"

#include "common/units.h"

namespace palpate::client {
namespace {
constexpr double kSmallStep = 10e-6;  // m: below it a step says little of the stiffness
constexpr double kStiffest = 50e3;    // N/m
}  // namespace

void LearnedStiffness::update(const Sample& sample) noexcept {
  const Time newest = samples_.newest.t;
  const int before = samples_.count;
  samples_.push(sample);
  if (samples_.count == before && samples_.newest.t == newest) return;
  if (sample.f.isZero(0) || samples_.count < 2 || samples_.before.f.isZero(0)) {
    b_.setZero();
    return;
  }
  const Vec3 s = samples_.newest.p - samples_.before.p, y = samples_.newest.f - samples_.before.f;
  const double sigma = s.squaredNorm() + kSmallStep * kSmallStep;
  const Vec3 r = y - b_ * s;
  b_ += (r * s.transpose() + s * r.transpose()) / sigma - (r.dot(s) / (sigma * sigma)) * s * s.transpose();
  const double size = b_.norm();
  if (!(size <= kStiffest)) b_ *= std::isfinite(size) ? kStiffest / size : 0;
  if (!b_.allFinite()) b_.setZero();
}

void LearnedStiffness::restart() noexcept {
  samples_ = {};
  b_.setZero();
}

Vec3 LearnedStiffness::force(const Vec3& p, Time) noexcept {
  const Sample& newest = samples_.newest;
  if (samples_.count == 0) return Vec3::Zero();
  const Vec3 x = p - newest.p;
  if (!(x.cwiseAbs().maxCoeff() < kMaxCoordinate)) return newest.f;
  return without_pull(newest.f + b_ * x, newest.f);
}

}  // namespace palpate::client
