#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/jitter.h"
#include "common/recent_least.h"
#include "common/time.h"

namespace palpate::client {

/// Rate limit of page requests, so that pages do not fill the queue of a slow link and delay samples. Each
/// 100 ms the rate doubles, and grows by half once a page has waited, while pages arrive almost as fast as
/// the fastest one. It is halved where a page waited 30 ms longer and four times what the delays of samples
/// jitter by, or was lost; at once where the rate had grown. LEDBAT (RFC 6817) takes queueing delay for the
/// signal of congestion likewise. The fastest is that of the last 10 to 20 s, as RFC 6817 has it for a
/// changed route. Pure; haptic thread.
class PagePace {
 public:
  static constexpr double kSlowest = 8, kFastest = 1000;  ///< pages a second

  /// Returns how many pages may be requested now.
  std::size_t allowed(Time now) noexcept;
  void requested(std::size_t pages) noexcept { tokens_ -= static_cast<double>(pages); }
  /// A page came `took` after it was asked for, once: which of several asks was answered nobody knows (Karn
  /// and Partridge 1987).
  void came(Time took) noexcept;
  /// A sample came so long after the tool was where it says.
  void heard(Time age) noexcept { jitter_.add(age); }
  /// Counts pages that are requested once more.
  void lost(std::uint64_t pages) noexcept { lost_ += pages; }

  /// After how long a page that did not come is lost: 200 ms, or more where the way is longer; twice as long
  /// each time that pages are, until one comes that was asked for once.
  Time patience() const noexcept;
  double rate() const noexcept { return rate_; }

 private:
  void adapt() noexcept;
  bool waits() const noexcept;

  double rate_ = 30, tokens_ = 2;      // a slow link is known only once something waited in it
  bool has_waited_ = false;            // some page did, or was lost
  bool rose_ = false;                  // the rate did last
  std::uint64_t came_ = 0, lost_ = 0;  // in this period
  RecentLeast fastest_;
  Time slowest_{};  // in this period
  Jitter jitter_;   // of samples
  Time backoff_{};  // the least patience, since pages were lost
  Time last_{}, period_{};
};

}  // namespace palpate::client
