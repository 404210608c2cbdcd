#include "haptic_client/safety/passivity.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {
namespace {
constexpr double kForget = 0.3;          // s, in which a debt that nothing pays is forgotten
constexpr double kFraction = 0.1;        // of the energy stored: what the reference may be wrong by
constexpr double kScaleMemory = 0.5;     // s
constexpr double kFree = 1e-3;           // N, below which a sample is free
constexpr double kComplianceMemory = 1;  // s
constexpr double kMassBound = 0.02;      // kg: damping times tick stays below, a fifth of a light handle
constexpr double kFullDamping = 1.5;     // debts at which damping is at its bound
constexpr double kSoften = 0.2;          // 1/s, by which the gain falls for each debt beyond the first
constexpr double kFastest = 10;          // 1/s, at most
constexpr double kReturn = 0.5;          // 1/s: back within 2 s, once
constexpr double kRecover = 0.05;        // 1/s, of a wall that needed a gain again
constexpr double kCalm = 20;             // s without a fall, until that is forgotten
constexpr double kLeastGain = 1e-3;      // of the force: 8 mN of 8 N
constexpr double kDampingRise = 0.1;     // s, from no damping to its bound: no sample makes a step of it
}  // namespace

const Passivity::Tick* Passivity::tick_at(Time t) const noexcept {
  for (std::size_t back = 1; back <= std::min(count_, kTicks); ++back) {
    const Tick& tick = ticks_[(count_ - back) % kTicks];
    if (tick.t <= t) return &tick;
  }
  return nullptr;
}

void Passivity::moved(Time t, const Vec3& d_D, const Vec3& surface_v_D, double dt) noexcept {
  if (!(dt > 0)) return;
  const double work = law_.dot(d_D - dt * surface_v_D), paid = -damper_.dot(d_D);
  if (std::isfinite(work)) work_ += work;
  ticks_[count_++ % kTicks] = {t, work_};
  if (std::isfinite(paid)) debt_ -= std::max(paid, 0.0);
  debt_ -= settings_.allowance * dt;
  debt_ = std::max(debt_, 0.0) * std::exp(-dt / kForget);
  scale_ *= std::exp(-dt / kScaleMemory);
}

void Passivity::learn_compliance(const Reference& next) noexcept {
  const double memory = std::exp(-to_seconds(next.t - last_.t) / kComplianceMemory);
  const Vec3 dp = next.p - last_.p, df = next.f - last_.f;
  moment_ = memory * moment_ - dp.dot(df);
  square_ = memory * square_ + df.squaredNorm();
}

double Passivity::stored(double force, double max_force) const noexcept {
  const double compliance = std::max(moment_, 0.0) / square_, rendered = std::min(force, max_force);
  return compliance * rendered * (force - rendered / 2);
}

void Passivity::sampled(Time t, const Vec3& p_D, const Vec3& f_D, double max_force) noexcept {
  const Reference next{true, p_D, f_D, t};
  const double force = f_D.norm();
  const bool touches = force > kFree;
  if (last_.known && touches && last_.f.norm() > kFree) learn_compliance(next);
  last_ = next;
  const Tick* tick = tick_at(t);
  if (tick == nullptr) {
    excess_known_ = false;
    return;
  }
  if (touches && !(square_ > kFree * kFree)) return;
  const double energy = touches ? stored(force, max_force) : 0, excess = tick->work + energy;
  if (!std::isfinite(excess)) return restart();
  scale_ = std::max(scale_, energy);
  if (excess_known_) owe(gain_ * (excess - excess_));
  excess_ = excess;
  excess_known_ = true;
}

void Passivity::owe(double energy) noexcept {
  debt_ += energy;
  counts_.largest_debt_j = std::max(counts_.largest_debt_j, debt_);
}

void Passivity::restart() noexcept {
  if (!std::isfinite(moment_) || !std::isfinite(square_)) moment_ = square_ = 0;
  last_.known = excess_known_ = false;
  debt_ = 0;
}

/// Returns by how much the gain may rise each second, and notes that it does. What made a debt once (a wild
/// sample, a jump of the organ) may be over; what makes one again is the wall.
double Passivity::recovery_rate(double pending, double dt) noexcept {
  recovery_.calm += std::max(dt, 0.0);
  if (recovery_.calm > kCalm) recovery_ = {};
  if (recovery_.is_slow || pending > 1) return kRecover;
  recovery_.returned = recovery_.returned || gain_ < 1;
  return kReturn;
}

Passivity::Ruling Passivity::rule(double dt) noexcept {
  if (!settings_.enabled) return {};
  const double pending = std::max(debt_, 0.0) / (settings_.debt + kFraction * scale_);
  const double most = dt > 0 ? std::min(settings_.damping, kMassBound / dt) : 0;
  if (pending > kFullDamping) {
    gain_ *= std::exp(-std::min(kSoften * (pending - kFullDamping), kFastest) * dt);
    gain_ = std::max(gain_, kLeastGain);
    recovery_ = {.returned = recovery_.returned, .is_slow = recovery_.is_slow || recovery_.returned};
  } else {
    gain_ = std::min(gain_ + recovery_rate(pending, dt) * dt, 1.0);
  }
  counts_.softened += gain_ < 1 ? 1 : 0;
  counts_.least_gain = std::min(counts_.least_gain, gain_);
  const double rise = std::max(dt, 0.0) / kDampingRise;
  const double wanted = std::clamp((pending - 1) / (kFullDamping - 1), 0.0, 1.0);
  damping_ = std::clamp(wanted, damping_ - rise, damping_ + rise);
  counts_.damped += damping_ > 0 ? 1 : 0;
  return {gain_, most * damping_};
}

}  // namespace palpate::client
