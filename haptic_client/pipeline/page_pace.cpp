#include "haptic_client/pipeline/page_pace.h"

#include <algorithm>
#include <utility>

namespace palpate::client {
namespace {

constexpr Time kPeriod = std::chrono::milliseconds(100);  // between two changes of the rate
constexpr Time kWaits = std::chrono::milliseconds(30);    // in a queue: longer is congestion
constexpr Time kLeastPatience = std::chrono::milliseconds(200),
               kMostPatience = std::chrono::seconds(2);  // until lost
constexpr double kFaster = 1.5, kSlower = 0.5;           // factors on the rate
constexpr double kStarts = 2;      // that until a page first waits (RFC 5681, slow start)
constexpr double kMostTokens = 8;  // pages at once
constexpr double kBurst = 0.1;     // s: pages that are requested at once take no longer at this rate

}  // namespace

std::size_t PagePace::allowed(Time now) noexcept {
  const double dt = last_ == Time{} ? 0 : std::clamp(to_seconds(now - last_), 0.0, 1.0);
  last_ = now;
  if (period_ == Time{}) period_ = now;
  if (now - period_ >= kPeriod || (rose_ && waits())) {
    adapt(to_seconds(now - period_));
    period_ = now;
  }
  fastest_.pass(now);
  tokens_ = std::min(tokens_ + rate() * dt, std::clamp(rate() * kBurst, 1.0, kMostTokens));
  return static_cast<std::size_t>(std::max(tokens_, 0.0));
}

void PagePace::came(Time took) noexcept {
  ++came_;
  fastest_.add(took);
  slowest_ = std::max(slowest_, took);
  backoff_ = {};
}

void PagePace::heard(Time age, Time step, Time now) noexcept {
  const Time whole = std::max(age, Time{}), on_the_way = whole - std::clamp(step, Time{}, whole);
  freshest_.pass(now);
  freshest_.add(on_the_way);
  jitter_.add(on_the_way);
  oldest_ = std::max(oldest_, on_the_way);
}

/// True if a page or a sample of this period waited in a queue, which they share.
bool PagePace::waits() const noexcept {
  const Time longest =
      std::max(slowest_ - fastest_.least().value_or(slowest_), oldest_ - freshest_.least().value_or(oldest_));
  return longest > kWaits + jitter_.most();
}

/// `span`: of the period, s.
void PagePace::adapt(double span) noexcept {
  if (lost_ > 0) backoff_ = std::min(2 * patience(), kMostPatience);
  rose_ = !waits() && lost_ == 0 && came_ > 0 && used_up_ && rate() == rate_;
  if (waits() || lost_ > 0) {
    has_waited_ = true;
    rate_ = std::max(kSlower * rate_, kSlowest);
  } else if (rose_) {
    const double carried = static_cast<double>(came_) / span,
                 more = has_waited_ ? kFaster * std::min(rate_, carried) : kStarts * rate_;
    rate_ = std::clamp(more, rate_, kFastest);
  }
  came_ = lost_ = 0;
  used_up_ = false;
  slowest_ = oldest_ = {};
}

Time PagePace::patience() const noexcept {
  const Time usual = std::clamp(3 * fastest_.least().value_or(Time{}), kLeastPatience, kMostPatience);
  return std::max(usual, backoff_);
}

}  // namespace palpate::client
