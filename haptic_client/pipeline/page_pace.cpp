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

}  // namespace

std::size_t PagePace::allowed(Time now) noexcept {
  const double dt = last_ == Time{} ? 0 : std::clamp(to_seconds(now - last_), 0.0, 1.0);
  last_ = now;
  if (period_ == Time{}) period_ = now;
  if (now - period_ >= kPeriod || (rose_ && waits())) {
    adapt();
    period_ = now;
  }
  fastest_.pass(now);
  tokens_ = std::min(tokens_ + rate_ * dt, kMostTokens);
  return static_cast<std::size_t>(std::max(tokens_, 0.0));
}

void PagePace::came(Time took) noexcept {
  ++came_;
  fastest_.add(took);
  slowest_ = std::max(slowest_, took);
  backoff_ = {};
}

/// True if a page of this period waited in a queue.
bool PagePace::waits() const noexcept {
  const std::optional<Time> fastest = fastest_.least();
  return fastest && slowest_ - *fastest > kWaits + jitter_.most();
}

void PagePace::adapt() noexcept {
  if (lost_ > 0) backoff_ = std::min(2 * patience(), kMostPatience);
  rose_ = !waits() && lost_ == 0 && came_ > 0;
  if (waits() || lost_ > 0) {
    has_waited_ = true;
    rate_ = std::max(kSlower * rate_, kSlowest);
  } else if (rose_) {
    rate_ = std::min((has_waited_ ? kFaster : kStarts) * rate_, kFastest);
  }
  came_ = lost_ = 0;
  slowest_ = {};
}

Time PagePace::patience() const noexcept {
  const Time usual = std::clamp(3 * fastest_.least().value_or(Time{}), kLeastPatience, kMostPatience);
  return std::max(usual, backoff_);
}

}  // namespace palpate::client
