#pragma once
#include <string>

#include "common/latest_value.h"
#include "protocol/link_stats.h"

namespace palpate::protocol {

/// Takes the counters of a link out of its network thread, and tells once a second, with `--debug`, what they
/// counted since the last time.
class LinkWatcher {
 public:
  /// Network thread; no allocation.
  void note(const LinkStats& stats) noexcept { newest_.write(stats); }
  /// A watching thread, ten times a second. `name` begins the line.
  void poll(const std::string& name);

 private:
  static constexpr int kPollsPerClock = 10;  // between two looks at the clock: a line a second
  LatestValue<LinkStats> newest_;
  LinkStats before_, now_;  // of the watching thread
  int polls_ = 0;
};

/// "30 sent, 1000 received, 2 lost": what was counted between two times; what did not happen is left out, but
/// for the first two.
std::string published_since(const LinkStats& before, const LinkStats& now);

}  // namespace palpate::protocol
