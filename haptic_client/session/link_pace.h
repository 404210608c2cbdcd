#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "common/jitter.h"
#include "common/recent_least.h"
#include "common/time.h"
#include "protocol/messages.h"

namespace palpate::client {

/// Names what the link carries, from all that a session uses down to the least that makes a force.
enum class LinkLevel : std::uint8_t {
  kFull,    ///< each tick in a datagram of its own
  kPacked,  ///< two datagrams a step, which hold the ticks between
  kPlain,   ///< the same, with few pages of the surface and little telemetry
  kLean,    ///< the same, with the tangent alone as part of a sample, and no pages
  kSparse,  ///< about one tick a step, the ticks between are not sent; samples have no parts
};
constexpr std::size_t kLinkLevels = static_cast<std::size_t>(LinkLevel::kSparse) + 1;
/// "full", "packed" and so on: a key for reports.
const char* name_of(LinkLevel level) noexcept;

/// Decides how much travels, so that the queue of a slow link does not grow. A queue delays all samples: the
/// least age of a few of them stands above that of the last 10 to 20 s (as in `PagePace`, after LEDBAT, RFC
/// 6817), by more than jitter explains (`Jitter`). Where it grows meanwhile, or is still there after
/// datagrams were lost, or stays, the level goes down by one. After a calm time the level goes up by one;
/// where that fails, twice the time passes until the next trial, and half of it once no level changed for so
/// long. Loss alone changes nothing, nor does a way that becomes longer at once, nor a stall, however often
/// it recurs. A session begins packed. Pure; network thread; no allocation.
class LinkPace {
 public:
  /// A sample came at `now`. `age`: since its tool position was read.
  void sample(const protocol::ForceSample& sample, Time age, Time now) noexcept;

  /// True if a datagram is to leave with the tick that was read at `now`. `rate_hz`: steps a second that the
  /// server aims for; 0: as many as it can.
  bool is_due(Time now, double rate_hz) noexcept;
  /// True if the ticks before it travel in this datagram.
  bool packs_ticks() const noexcept { return level_ != LinkLevel::kSparse; }
  /// Takes off the parts of a sample that the level does not ask for. Pages pass: `pages_hz` bounds those
  /// where they are chosen, since a request that is dropped looks like a page that the link lost.
  void shrink(protocol::ToolState& state) const noexcept;
  /// Returns how many pages of the surface a second the level leaves room for; below 0: as `PagePace` finds.
  double pages_hz() const noexcept;
  /// True if a message for the page may leave at `now`.
  bool carries_telemetry(Time now) noexcept;

  LinkLevel level() const noexcept { return level_; }
  /// Time from the first tick to the newest that was spent on each level.
  const std::array<Time, kLinkLevels>& spent() const noexcept { return spent_; }

  /// States a second that leave at least: a server takes a longer gap for a tool that went away.
  static constexpr double kFewestStates = 20;
  static constexpr double kMostSteps = 30;  ///< a second, that a link below `kFull` carries
  static constexpr Time kWaits = std::chrono::milliseconds(50);  ///< in a queue: longer is congestion

 private:
  /// A few samples in a row.
  struct Look {
    Time began{}, least_age{};
    std::uint64_t came = 0, newest = 0;  // how many samples, and the number of the newest
    protocol::UplinkCounts uplink{};     // of the newest
  };
  bool is_congested(Time delay, Time before, Time now) noexcept;
  void judge(Time delay, Time now) noexcept;
  bool loses() const noexcept;
  void change(LinkLevel level, Time now) noexcept;

  LinkLevel level_ = LinkLevel::kPacked;
  std::array<Time, kLinkLevels> spent_{};
  Time ticked_{}, sent_{}, told_{};  // newest tick; when the last datagram, telemetry left
  Time settled_{};                   // not judged before: the queue needs time to follow
  Time raised_{};                    // when the level last went up
  Time calm_ = kFirstCalm;           // how long it must be before more is tried
  Time quiet_since_{};               // when the level last changed, or `calm_` became shorter
  std::optional<Time> calm_since_, waits_since_, loses_since_;
  int grew_ = 0;       // looks in a row in which the delay did
  RecentLeast least_;  // age
  Time delay_{};       // of the look before
  Look look_, before_;
  Jitter jitter_;

  static constexpr Time kFirstCalm = std::chrono::seconds(1);
};

}  // namespace palpate::client
