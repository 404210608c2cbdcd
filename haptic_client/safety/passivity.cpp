#include "haptic_client/safety/passivity.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {
namespace {
constexpr double kRecovery = 0.1;  // s, from nothing to all: a flickering encoder does not pump energy
constexpr double kForget = 0.3;    // s, for debt where nothing pushes
}  // namespace
void Passivity::moved(const Vec3& d_D, double dt) noexcept {
  if (!(dt > 0)) return;
  const double work = written_.dot(d_D);
  if (std::isfinite(work)) energy_ += work;
  if (energy_ > 0) energy_ = std::max(energy_ - settings_.allowance * dt, 0.0);
  if (written_.isZero(0)) energy_ = std::max(energy_, 0.0) * std::exp(-dt / kForget);
  counts_.largest_debt_j = std::max(counts_.largest_debt_j, energy_);
}

double Passivity::share(double dt) noexcept {
  if (!settings_.enabled) return 1;
  const double owed = std::max(energy_, 0.0) / settings_.debt, most = std::exp(-owed * owed);
  share_ = std::min(most, share_ + std::max(dt, 0.0) / kRecovery);
  counts_.reduced += share_ < 1 ? 1 : 0;
  return share_;
}

}  // namespace palpate::client
