#pragma once
#include <algorithm>

#include "common/time.h"

namespace palpate::protocol {

/// Lets through so many things a second on the long run, and `most` of them at once. One thread.
class TokenBucket {
 public:
  TokenBucket(double per_second, double most) : per_second_(per_second), most_(most), remaining_(most) {}

  /// Takes one token; true if one more may pass at `now`. Times never decrease.
  bool take(Time now) noexcept {
    remaining_ = std::min(most_, remaining_ + per_second_ * to_seconds(now - last_));
    last_ = now;
    if (remaining_ < 1) return false;
    remaining_ -= 1;
    return true;
  }

 private:
  double per_second_, most_, remaining_;
  Time last_{};
};

}  // namespace palpate::protocol
