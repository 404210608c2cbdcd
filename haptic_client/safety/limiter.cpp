#include "haptic_client/safety/limiter.h"

#include <algorithm>

#include "common/ages.h"

namespace palpate::client {
namespace {
constexpr double kStormWindow = 1;      // s
constexpr double kStormFraction = 0.5;  // of the window
constexpr double kExcessiveTime = 0.5;  // s
}  // namespace

Vec3 Limiter::clamp(const Vec3& f_D, double dt) noexcept {
  const bool implausible = is_implausible(f_D);
  excessive_time_ = implausible ? excessive_time_ + std::clamp(dt, 0.0, kLongestTick) : 0;
  if (excessive_time_ > kExcessiveTime) latch(Fault::kExcessive);
  const Vec3 f = within(1, f_D);
  counts_.clamped += f != f_D ? 1 : 0;
  return f;
}

bool Limiter::is_implausible(const Vec3& f) const noexcept {
  constexpr double kExcessive = 100;  // of the largest force
  return f.stableNorm() > kExcessive * settings_.max_force;
}

Vec3 Limiter::push(const Vec3& f_D, double dt) noexcept {
  if (!f_D.allFinite()) latch(Fault::kNotFinite);
  if (fault_ != Fault::kNone) return drop();
  // Cut to the ball first, so that a wild wish cannot use up the slew in a wild direction.
  const Vec3 wish = within(1, f_D), change = wish - push_;
  const double most = settings_.max_slew * std::clamp(dt, 0.0, kLongestTick);
  const bool slewed = change.norm() > most;
  push_ = slewed ? Vec3(push_ + most / change.norm() * change) : wish;
  counts_.slewed += slewed ? 1 : 0;
  watch_for_storm(slewed, dt);
  return push_;
}

Vec3 Limiter::within(double fraction, const Vec3& f_D) const noexcept {
  constexpr double kRounding = 1 - 1e-15;  // of the products below: never a bit beyond
  const double size = f_D.stableNorm(), most = fraction * settings_.max_force;  // stable: no overflow
  return size <= most ? f_D : Vec3(f_D * (kRounding * most / size));
}

void Limiter::watch_for_storm(bool slewed, double dt) noexcept {
  const double counts = std::clamp(dt, 0.0, kLongestTick);  // one late tick is no storm
  window_ += counts;
  slewed_time_ += slewed ? counts : 0;
  if (window_ < kStormWindow) return;
  if (slewed_time_ > kStormFraction * window_) latch(Fault::kStorm);
  window_ = slewed_time_ = 0;
}

void Limiter::latch(Fault fault) noexcept {
  push_.setZero();
  if (fault_ != Fault::kNone) return;
  fault_ = fault;
  ++(fault == Fault::kStorm       ? counts_.storms
     : fault == Fault::kExcessive ? counts_.implausible
                                  : counts_.not_finite);
  excessive_time_ = 0;
}

}  // namespace palpate::client
