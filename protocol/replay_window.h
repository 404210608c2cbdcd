#pragma once
#include <cstdint>

#include "protocol/link_stats.h"

namespace palpate::protocol {

/// Sequence numbers of one sender seen so far: the highest, and which of the 63 before it (the sliding window
/// of RFC 4303, section 3.4.3). Pure; a few instructions.
class ReplayWindow {
 public:
  /// True if `sequence` (>= 1) was not seen before; counts it in `stats`. A duplicate, or a number more than
  /// 64 behind, is refused. Sequence 0 is refused always.
  bool accept(std::uint64_t sequence, LinkStats& stats) noexcept {
    if (sequence > highest_) {
      const std::uint64_t ahead = sequence - highest_;
      seen_ = ahead >= 64 ? 0 : seen_ << ahead;
      seen_ |= 1;
      highest_ = sequence;
      stats.lost += ahead - 1;
      ++stats.received;
      return true;
    }
    const std::uint64_t behind = highest_ - sequence;
    if (sequence == 0 || behind >= 64 || (seen_ >> behind & 1) != 0) {
      ++stats.duplicated;
      return false;
    }
    seen_ |= std::uint64_t{1} << behind;
    --stats.lost;  // it was counted as lost when a later one came
    ++stats.received;
    ++stats.reordered;
    return true;
  }

 private:
  std::uint64_t highest_ = 0, seen_ = 0;
};

}  // namespace palpate::protocol
