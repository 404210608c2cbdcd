#pragma once
#include <deque>

#include "sim_server/viewer/feed.h"
#include "sim_server/viewer/page_link.h"

namespace palpate::sim {

/// Takes what is new out of the feed and makes of it what pages are shown. Page's thread; no clock.
class ShowingMaker {
 public:
  /// `live`: as in `Showing`. Both outlive this.
  ShowingMaker(const SceneFacts& scene, ViewerFeed& feed, bool live);

  /// Looks for news; `now` is for the rates.
  void update(Time now);
  const Showing& showing() const { return showing_; }

 private:
  void measure(Time now);

  ViewerFeed& feed_;
  Showing showing_;
  struct Mark {
    Time t;
    std::uint64_t step;
    double simulated;
  };
  std::deque<Mark> marks_;  // of the last second
  bool fresh_ = false;      // a picture came since the first page did: before, they are of long ago
};

}  // namespace palpate::sim
