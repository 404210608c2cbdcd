#include "haptic_client/extrapolation/kalman.h"

namespace palpate::client {
namespace {
constexpr double kProcess = 100;     // N^2/s^3
constexpr double kMeasured = 1e-6;   // N^2
constexpr double kAnyRate = 1e4;     // N^2/s^2: nothing is known of the rate at first
constexpr double kUnbounded = 1e15;  // N, N/s
}  // namespace

void Kalman::update(const Sample& sample) noexcept {
  if (!usable(sample) || (any_ && sample.t <= t_)) return;
  if (!any_ || sample.f.cwiseAbs().maxCoeff() > kUnbounded) {
    *this = {};
    any_ = true;
    t_ = sample.t;
    f_ = sample.f;
    p00_ = kMeasured;
    p11_ = kAnyRate;
    return;
  }
  const double dt = to_seconds(sample.t - t_);
  t_ = sample.t;
  f_ += dt * rate_;
  p00_ += dt * (2 * p01_ + dt * p11_) + kProcess * dt * dt * dt / 3;
  p01_ += dt * p11_ + kProcess * dt * dt / 2;
  p11_ += kProcess * dt;
  const double k0 = p00_ / (p00_ + kMeasured), k1 = p01_ / (p00_ + kMeasured);
  const Vec3 innovation = sample.f - f_;
  f_ += k0 * innovation;
  rate_ += k1 * innovation;
  p11_ -= k1 * p01_;
  p01_ *= 1 - k0;
  p00_ *= 1 - k0;
  const bool sane =
      f_.allFinite() && rate_.cwiseAbs().maxCoeff() < kUnbounded && p11_ >= 0 && p11_ < kUnbounded;
  if (!sane) {
    *this = {};
    update(sample);
  }
}

Vec3 Kalman::force(const Vec3&, Time t) noexcept {
  return f_ + to_seconds(t - t_) * rate_;
}

}  // namespace palpate::client
