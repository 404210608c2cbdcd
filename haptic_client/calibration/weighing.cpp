#include "haptic_client/calibration/weighing.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kAgree = 0.05, kAgreeFraction = 0.03;  // N; of the force
}

void Weighing::add(const Vec3& p_D, const Vec3& f_D, double dt) noexcept {
  time_ += dt;
  swing_.add(p_D, f_D, dt);
  if (!swing_.complete()) return;
  held_ = swing_.held();
  if (!settling_ && !held_) forces_[swings_++ % forces_.size()] = swing_.mean_force();
  if (held_) swings_ = 0;
  settling_ = held_;
  swing_ = {};
}

bool Weighing::done() const noexcept {
  return swings_ >= forces_.size() && spread() <= std::max(kAgree, kAgreeFraction * force().norm());
}

double Weighing::spread() const noexcept {
  double spread = 0;
  for (const Vec3& force : forces_) spread = std::max(spread, (force - this->force()).norm());
  return spread;
}

}  // namespace palpate::client
