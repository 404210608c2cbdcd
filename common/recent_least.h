#pragma once
#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "common/time.h"

namespace palpate {

/// Finds the least of the delays of the last 10 to 20 s: that of a way without a queue, which may become
/// longer (LEDBAT, RFC 6817, keeps its base delay likewise). Pure; no allocation.
class RecentLeast {
 public:
  /// Forgets what is older by `now`.
  void pass(Time now) noexcept {
    if (now - began_ < kWindow) return;
    before_ = std::exchange(newest_, std::nullopt);
    began_ = now;
  }
  void add(Time delay) noexcept { newest_ = std::min(newest_.value_or(delay), delay); }
  /// Returns nothing where none was added so lately.
  std::optional<Time> least() const noexcept {
    if (!newest_ || !before_) return newest_ ? newest_ : before_;
    return std::min(*newest_, *before_);
  }

 private:
  static constexpr Time kWindow = std::chrono::seconds(10);
  Time began_{};
  std::optional<Time> newest_, before_;  // of this window of time, and of the one before
};

}  // namespace palpate
