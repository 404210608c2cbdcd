#pragma once
#include <algorithm>
#include <vector>

#include "common/ages.h"

namespace palpate::client {

/// Ring of the last ticks, to compare with a sample that comes later: a quarter of a second at 4 kHz. Only
/// the constructor allocates.
template <class Entry>
class TickMemory {
 public:
  TickMemory() : ring_(kTicks) {}

  /// Room for a tick at `t`; null where one as late is there.
  Entry* add(Time t) noexcept {
    if (written_ > 0 && ring_[(written_ - 1) % kTicks].t >= t) return nullptr;
    Row& row = ring_[written_++ % kTicks];
    row.t = t;
    return &row.entry;
  }
  /// The tick at `t`, or the one before; null where that is longer ago than any tick takes.
  const Entry* at(Time t) const noexcept { return const_cast<TickMemory*>(this)->at(t); }
  Entry* at(Time t) noexcept {
    for (std::size_t back = 1; back <= std::min(written_, kTicks); ++back) {
      Row& row = ring_[(written_ - back) % kTicks];
      if (row.t <= t) return t - row.t <= kTickGap ? &row.entry : nullptr;
    }
    return nullptr;
  }
  /// Calls `work(t, entry)` with each tick later than `t`, in the order of time.
  template <class Work>
  void for_each_since(Time t, const Work& work) {
    std::size_t back = 0;
    while (back < std::min(written_, kTicks) && ring_[(written_ - back - 1) % kTicks].t > t) ++back;
    for (; back > 0; --back) {
      Row& row = ring_[(written_ - back) % kTicks];
      work(row.t, row.entry);
    }
  }
  void forget() noexcept { written_ = 0; }

 private:
  static constexpr std::size_t kTicks = 1024;  // a quarter of a second at 4 kHz, a second at 1 kHz
  struct Row {
    Time t;
    Entry entry;
  };
  std::vector<Row> ring_;
  std::size_t written_ = 0;
};

}  // namespace palpate::client
