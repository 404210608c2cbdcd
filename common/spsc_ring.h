#pragma once
#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

namespace palpate {

/// Wait-free first-in-first-out ring between one writer and one reader, for what must not be overtaken: the
/// poses of every tick, the packets of a recording. Full, it refuses; neither side waits, locks or allocates.
template <class T>
class SpscRing {
 public:
  /// Room for at least `capacity` >= 1 values; all memory is taken here.
  explicit SpscRing(std::size_t capacity) : slots_(std::bit_ceil(capacity)) {}

  /// Writer thread only: a slot to fill, or null when the ring is full. `publish` hands it over.
  T* claim() noexcept {
    const std::size_t write = write_.load(std::memory_order_relaxed);
    if (write - read_.load(std::memory_order_acquire) == slots_.size()) return nullptr;
    return &slots_[write & (slots_.size() - 1)];
  }
  void publish() noexcept { write_.fetch_add(1, std::memory_order_release); }

  /// Writer thread only: false when the ring is full.
  bool push(const T& value) noexcept {
    T* const slot = claim();
    if (slot == nullptr) return false;
    *slot = value;
    publish();
    return true;
  }

  /// Reader thread only: the oldest value, or null when there is none; `release` gives its slot back.
  const T* front() noexcept {
    const std::size_t read = read_.load(std::memory_order_relaxed);
    if (read == write_.load(std::memory_order_acquire)) return nullptr;
    return &slots_[read & (slots_.size() - 1)];
  }
  void release() noexcept { read_.fetch_add(1, std::memory_order_release); }

  /// Reader thread only: false when there is none.
  bool pop(T& out) noexcept {
    const T* const slot = front();
    if (slot == nullptr) return false;
    out = *slot;
    release();
    return true;
  }

  std::size_t capacity() const noexcept { return slots_.size(); }

 private:
  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> write_{0};
  alignas(64) std::atomic<std::size_t> read_{0};
};

}  // namespace palpate
