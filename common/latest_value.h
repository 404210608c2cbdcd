#pragma once
#include <array>
#include <atomic>
#include <cstdint>

namespace palpate {

/// Wait-free mailbox between one writer and one reader that keeps only the newest value (a triple buffer: one
/// slot being written, one being read, one in between). Neither side ever waits, locks or allocates; a value
/// that was overtaken before it was read is gone. `T` is copied whole, so keep it trivially copyable and
/// small.
template <class T>
class LatestValue {
 public:
  /// Writer thread only: replaces whatever waits.
  void write(const T& value) noexcept {
    slots_[back_] = value;
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  /// Reader thread only: copies the newest value into `out` and returns true if one came since the last read;
  /// otherwise leaves `out` alone and returns false.
  bool read(T& out) noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    out = slots_[front_];
    return true;
  }

 private:
  static constexpr std::uint32_t kFresh = 4, kIndex = 3;
  std::array<T, 3> slots_{};
  std::atomic<std::uint32_t> middle_{1};
  alignas(64) std::uint32_t back_ = 0;   // the writer's own
  alignas(64) std::uint32_t front_ = 2;  // the reader's own
};

}  // namespace palpate
