#include "haptic_client/safety/limiter.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kLongestTick = 0.01;  // s
constexpr double kStormWindow = 1;     // s
constexpr double kStormShare = 0.5;    // of the window
}  // namespace

Vec3 Limiter::limit(const Vec3& f_D, const Vec3& damping_D, double dt, double gain) noexcept {
  if (!f_D.allFinite() || !damping_D.allFinite()) latch(Fault::kNotFinite);
  if (fault_ != Fault::kNone) {
    last_.setZero();
    return last_;
  }
  // Cut to the ball first, so that a wild wish cannot use up the slew in a wild direction.
  Vec3 f = within_magnitude(f_D);
  bool clamped = f != f_D;
  f *= gain;
  const Vec3 change = f - last_;
  const double most = settings_.max_slew * std::clamp(dt, 0.0, kLongestTick);
  const bool slewed = change.norm() > most;
  if (slewed) f = last_ + most / change.norm() * change;
  last_ = f;
  const Vec3 damped = f + damping_D;
  f = within_magnitude(damped);
  clamped = clamped || f != damped;
  counts_.clamped += clamped ? 1 : 0;
  counts_.slewed += slewed ? 1 : 0;
  watch_for_storm(slewed, dt);
  return fault_ == Fault::kNone ? f : Vec3(Vec3::Zero());
}

Vec3 Limiter::within_magnitude(const Vec3& f) const noexcept {
  const double size = f.stableNorm();  // no overflow
  return size <= settings_.max_force ? f : Vec3(f * (settings_.max_force / size));
}

void Limiter::watch_for_storm(bool slewed, double dt) noexcept {
  window_ += dt;
  slewed_time_ += slewed ? dt : 0;
  if (window_ < kStormWindow) return;
  if (slewed_time_ > kStormShare * window_) latch(Fault::kStorm);
  window_ = slewed_time_ = 0;
}

void Limiter::latch(Fault fault) noexcept {
  last_.setZero();
  if (fault_ != Fault::kNone) return;
  fault_ = fault;
  ++counts_.latched;
}

}  // namespace palpate::client
