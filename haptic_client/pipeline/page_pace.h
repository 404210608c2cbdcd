#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/jitter.h"
#include "common/recent_least.h"
#include "common/time.h"

namespace palpate::client {

/// Rate limit of page requests, so that pages do not fill the queue of a slow link and delay samples. Each
/// 100 ms the rate doubles while pages arrive almost as fast as the fastest one and all that it allows are
/// requested: a rate that nothing used tells nothing of the link (RFC 7661). Once a page has waited it grows
/// up to 1.5 times the rate at which pages arrive, which is what the link carries. It is halved where a page
/// or a sample waited 30 ms longer and four times what the delays of samples jitter by, or a page was lost;
/// at once where the rate had grown. LEDBAT (RFC 6817) takes queueing delay for the signal of congestion
/// likewise. The fastest is that of the last 10 to 20 s, as RFC 6817 has it for a changed route. Samples come
/// first: pages take what they leave, within the bound that the link's level sets (`LinkPace::pages_hz`).
/// Pure; haptic thread.
class PagePace {
 public:
  static constexpr double kSlowest = 8, kFastest = 1000;  ///< pages a second

  /// Returns how many pages may be requested now.
  std::size_t allowed(Time now) noexcept;
  void requested(std::size_t pages) noexcept {
    tokens_ -= static_cast<double>(pages);
    used_up_ |= tokens_ < 1;
  }
  /// A page came `took` after it was asked for, once: which of several asks was answered nobody knows (Karn
  /// and Partridge 1987).
  void came(Time took) noexcept;
  /// A sample came at `now`, `age` after the tool was where it says. `step`: what the server took of that.
  void heard(Time age, Time step, Time now) noexcept;
  /// Bounds the rate by what the link leaves for pages, pages a second; below 0: nothing bounds it.
  void bound(double pages_hz) noexcept { bound_ = pages_hz; }
  /// Counts pages that are requested once more.
  void lost(std::uint64_t pages) noexcept { lost_ += pages; }

  /// After how long a page that did not come is lost: 200 ms, or more where the way is longer; twice as long
  /// each time that pages are, until one comes that was asked for once.
  Time patience() const noexcept;
  /// Returns how many pages a second may be requested.
  double rate() const noexcept { return bound_ < 0 ? rate_ : std::min(rate_, bound_); }

 private:
  void adapt(double span) noexcept;
  bool waits() const noexcept;

  double rate_ = 30, tokens_ = 2;      // a slow link is known only once something waited in it
  bool has_waited_ = false;            // some page did, or was lost
  double bound_ = -1;                  // on the rate
  bool rose_ = false;                  // the rate did last
  bool used_up_ = false;               // no more was allowed, in this period
  std::uint64_t came_ = 0, lost_ = 0;  // in this period
  RecentLeast fastest_, freshest_;     // page, sample
  Time slowest_{}, oldest_{};          // page, sample in this period
  Jitter jitter_;                      // of samples
  Time backoff_{};                     // the least patience, since pages were lost
  Time last_{}, period_{};
};

}  // namespace palpate::client
