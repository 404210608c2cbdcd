#include "haptic_client/safety/limiter.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kLongestTick = 0.01;  // s
constexpr double kStormWindow = 1;     // s
constexpr double kStormShare = 0.5;    // of the window
}  // namespace

Vec3 Limiter::push(const Vec3& f_D, double dt, const Shares& shares) noexcept {
  clamped_ = false;
  if (!f_D.allFinite()) latch(Fault::kNotFinite);
  if (fault_ != Fault::kNone) return drop();
  // Cut to the ball first, so that a wild wish cannot use up the slew in a wild direction.
  const Vec3 within = within_magnitude(f_D);
  clamped_ = within != f_D;
  if (shares.passive < passive_) push_ *= shares.passive / passive_;
  passive_ = shares.passive;
  const Vec3 wish = shares.fade * shares.passive * within, change = wish - push_;
  const double most = settings_.max_slew * std::clamp(dt, 0.0, kLongestTick);
  const bool slewed = change.norm() > most;
  push_ = slewed ? Vec3(push_ + most / change.norm() * change) : wish;
  counts_.slewed += slewed ? 1 : 0;
  watch_for_storm(slewed, dt);
  return push_;
}

Vec3 Limiter::finish(const Vec3& damping_D) noexcept {
  if (!damping_D.allFinite()) latch(Fault::kNotFinite);
  if (fault_ != Fault::kNone) return drop();
  const Vec3 damped = push_ + damping_D, f = within_magnitude(damped);
  counts_.clamped += clamped_ || f != damped ? 1 : 0;
  return f;
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
  push_.setZero();
  if (fault_ != Fault::kNone) return;
  fault_ = fault;
  ++(fault == Fault::kStorm ? counts_.storms : counts_.not_finite);
}

}  // namespace palpate::client
