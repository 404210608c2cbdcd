#include "haptic_client/pipeline/page_pace.h"

#include <algorithm>

namespace palpate::client {
namespace {

constexpr Time kPeriod = std::chrono::milliseconds(100), kWaits = std::chrono::milliseconds(30);
constexpr Time kLeastPatience = std::chrono::milliseconds(200), kMostPatience = std::chrono::seconds(2);
constexpr double kMostTokens = 8, kFaster = 1.5, kSlower = 0.5;

}  // namespace

std::size_t PagePace::allowed(Time now) noexcept {
  const double dt = last_ == Time{} ? 0 : std::clamp(to_seconds(now - last_), 0.0, 1.0);
  last_ = now;
  if (period_ == Time{}) period_ = now;
  if (now - period_ >= kPeriod) {
    adapt();
    period_ = now;
  }
  tokens_ = std::min(tokens_ + rate_ * dt, kMostTokens);
  return static_cast<std::size_t>(std::max(tokens_, 0.0));
}

void PagePace::came(Time took) noexcept {
  ++came_;
  quickest_ = std::min(quickest_.value_or(took), took);
  slowest_ = std::max(slowest_, took);
}

void PagePace::adapt() noexcept {
  const bool waits = quickest_ && slowest_ - *quickest_ > kWaits;
  if (waits || lost_ > 0) {
    rate_ = std::max(kSlower * rate_, kSlowest);
  } else if (came_ > 0) {
    rate_ = std::min(kFaster * rate_, kFastest);
  }
  came_ = lost_ = 0;
  slowest_ = {};
}

Time PagePace::patience() const noexcept {
  return quickest_ ? std::clamp(3 * *quickest_, kLeastPatience, kMostPatience) : kLeastPatience;
}

}  // namespace palpate::client
