#pragma once
#include <atomic>
#include <cstdint>

namespace palpate::client {

/// That a haptic loop goes on, for the guardian in another process: one for each loop, so that none hides
/// another that hangs.
struct Heartbeat {
  static constexpr std::uint64_t kEnded = ~std::uint64_t{0};

  void beat() noexcept { ticks.fetch_add(1, std::memory_order_relaxed); }
  /// The loop is over, and its device has had its zero.
  void end() noexcept { ticks.store(kEnded, std::memory_order_relaxed); }

  std::atomic<std::uint64_t> ticks{0};  ///< 0: not begun
};

}  // namespace palpate::client
