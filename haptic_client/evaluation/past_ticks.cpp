#include "haptic_client/evaluation/past_ticks.h"

namespace palpate::client {
namespace {
/// A tick waits for the next sample (an outage at most) to be computed, and as long for it to arrive.
constexpr double kLongestWait = 3 * to_seconds(kOutage);  // s
}  // namespace

PastTicks::PastTicks(double rate_hz) : ring_(longest_wait(rate_hz)) {}

std::size_t PastTicks::longest_wait(double rate_hz) {
  return static_cast<std::size_t>(kLongestWait * rate_hz) + 1;
}

PathTick PastTicks::at(const Vec3& p_W, Time t) noexcept {
  PathTick tick{t, p_W};
  if (contact_) tick.contact = contact_->follow(p_W, t);
  return tick;
}

void PastTicks::wait(const PastTick& tick) noexcept {
  if (waiting_ == ring_.size()) drop();
  ring_[(first_ + waiting_++) % ring_.size()] = tick;
}

}  // namespace palpate::client
