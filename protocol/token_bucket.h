#pragma once
#include <algorithm>

#include "common/time.h"

namespace palpate::protocol {

/// Lets through so many things a second on the long run, and `most` of them at once. One thread.
class TokenBucket {
 public:
  TokenBucket(double per_second, double most) : per_second_(per_second), most_(most), left_(most) {}

  /// Takes one token; true if one more may pass at `now`. Times never decrease.
  bool take(Time now) noexcept {
    left_ = std::min(most_, left_ + per_second_ * to_seconds(now - last_));
    last_ = now;
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }

 private:
  double per_second_, most_, left_;
  Time last_{};
};

}  // namespace palpate::protocol
