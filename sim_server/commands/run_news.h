#pragma once
#include <vector>

#include "sim_server/cutting/resection.h"
#include "sim_server/serving/net_link.h"
#include "sim_server/serving/sim_loop.h"

namespace palpate::sim {

/// What a run says while it goes on, once each: who takes tools and leaves them, that a page has paused, that
/// a tool left its reach, and that a cut came to the end of what can be cut. Of the thread that watches the
/// run.
class RunNews {
 public:
  /// Of a scene, which outlives this.
  explicit RunNews(const Scene& scene);
  /// What is new since the last call.
  void tell(const NetLink& link, const SimLoop& loop, bool paused);

 private:
  void tell_paused(bool paused);
  void tell_holders(const NetLink& link, bool paused);
  void tell_beyond(const SimLoop& loop);
  void tell_end(const SimLoop& loop);

  const Scene& scene_;
  bool paused_ = false, at_end_ = false;
  std::vector<bool> held_, beyond_;
};

}  // namespace palpate::sim
