#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <utility>

namespace palpate {

/// Building block of `LatestValue`, for values that are filled in place, as they own memory: one slot being
/// written, one being read, one in between. Neither side ever waits, locks or allocates. Each slot holds its
/// earlier content, so a writer that sets only a part of it must know that another turn set the rest.
template <class T>
class TripleBuffer {
 public:
  TripleBuffer() = default;
  /// Starts all three slots as copies of this.
  explicit TripleBuffer(const T& first) : slots_{first, first, first} {}

  /// Writer thread only: the slot to fill; `publish` hands it over, in the place of one that nobody read.
  T& back() noexcept { return slots_[back_]; }
  void publish() noexcept { back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex; }

  /// Reader thread only: makes the newest value the one at `front`; false if none came since the last time.
  bool take() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  const T& front() const noexcept { return slots_[front_]; }

 private:
  static constexpr std::uint32_t kFresh = 4, kIndex = 3;  // a bit beside the index, and the mask of the index
  std::array<T, 3> slots_{};
  std::atomic<std::uint32_t> middle_{1};
  alignas(64) std::uint32_t back_ = 0;   // the writer's own
  alignas(64) std::uint32_t front_ = 2;  // the reader's own
};

}  // namespace palpate
