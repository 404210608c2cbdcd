#pragma once
#include <atomic>
#include <cstdint>

namespace palpate::client {

/// That a haptic loop goes on, for the guardian in another process: one for each loop, so that none hides
/// another that hangs.
struct Heartbeat {
  // Numbers that no count of ticks reaches.
  static constexpr std::uint64_t kEnded = ~std::uint64_t{0}, kReleasedPushing = kEnded - 1;

  void beat() noexcept { ticks.fetch_add(1, std::memory_order_relaxed); }
  /// The loop is over. `at_rest`: its device has had its zero; else the guardian is to take it over.
  void end(bool at_rest) noexcept {
    ticks.store(at_rest ? kEnded : kReleasedPushing, std::memory_order_relaxed);
  }

  std::atomic<std::uint64_t> ticks{0};  ///< 0: not begun
};

}  // namespace palpate::client
