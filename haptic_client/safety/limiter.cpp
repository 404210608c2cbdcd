#include "haptic_client/safety/limiter.h"

namespace palpate::client {
namespace {
constexpr double kStormWindow = 1;   // s
constexpr double kStormShare = 0.5;  // of the window
}  // namespace

Vec3 Limiter::limit(const Vec3& f_D, const Vec3& damping_D, double dt) noexcept {
  if (!f_D.allFinite() || !damping_D.allFinite()) latch(Fault::kNotFinite);
  if (fault_ != Fault::kNone) {
    last_.setZero();
    return last_;
  }
  // Cut to the ball first, so that a wild wish cannot use up the slew in a wild direction. stableNorm: no
  // overflow.
  Vec3 f = f_D;
  bool clamped = false;
  const auto clamp = [&](Vec3& v) {
    const double size = v.stableNorm();
    if (size <= settings_.max_force) return;
    v *= settings_.max_force / size;
    clamped = true;
  };
  clamp(f);
  const Vec3 change = f - last_;
  const double most = settings_.max_slew * (dt > 0 ? dt : 0);
  const bool slewed = change.norm() > most;
  if (slewed) f = last_ + most / change.norm() * change;
  last_ = f;
  f += damping_D;
  clamp(f);
  counts_.clamped += clamped ? 1 : 0;
  counts_.slewed += slewed ? 1 : 0;
  watch_for_storm(slewed, dt);
  return fault_ == Fault::kNone ? f : Vec3(Vec3::Zero());
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
