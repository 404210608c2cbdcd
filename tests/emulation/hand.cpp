#include "tests/emulation/hand.h"

#include <algorithm>
#include <numbers>

namespace palpate::emulation {

void Hand::begin(const Move& move, const Vec& from) {
  from_ = from;
  to_ = move.target;
  seconds_ = move.seconds;
  elapsed_ = 0;
}

void Hand::move(const Vec& target, double seconds) {
  waiting_.clear();
  begin({target, seconds}, target_at(elapsed_));
}

void Hand::advance(double dt) {
  time_ += dt;
  elapsed_ += dt;
  if (elapsed_ < seconds_ || waiting_.empty()) return;
  begin(waiting_.front(), to_);
  waiting_.pop_front();
}

Vec Hand::target_at(double elapsed) const {
  const double s = seconds_ > 0 ? std::clamp(elapsed / seconds_, 0.0, 1.0) : 1.0;
  return from_ + s * s * s * (10 - 15 * s + 6 * s * s) * (to_ - from_);
}

Vec Hand::target_velocity() const {
  if (seconds_ <= 0 || elapsed_ >= seconds_) return {};
  const double s = elapsed_ / seconds_;
  return 30 * s * s * (1 - s) * (1 - s) / seconds_ * (to_ - from_);
}

Vec Hand::tremor_at(double time) const {
  if (tremor <= 0) return {};
  const double turn =
      2 * std::numbers::pi * tremor_rate * time;  // three rates that do not lock to each other
  return tremor * Vec{std::sin(turn), std::sin(1.13 * turn + 1), std::sin(0.91 * turn + 2)};
}

Vec Hand::force(const Vec& position, const Vec& velocity) const {
  return stiffness * (target() + tremor_at(time_) - position) + damping * (target_velocity() - velocity);
}

}  // namespace palpate::emulation
