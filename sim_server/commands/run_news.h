#pragma once
#include <array>
#include <vector>

#include "common/report.h"
#include "sim_server/cutting/resection.h"
#include "sim_server/serving/net_link.h"
#include "sim_server/serving/sim_loop.h"

namespace palpate::sim {

/// Messages of a run, once each. They report who takes and returns tools, a pause by a page, a tool beyond
/// its reach, and a cut without further removable tissue. Used by the thread that watches the run.
class RunEvents {
 public:
  /// Reports on a scene, which outlives this.
  explicit RunEvents(const Scene& scene);
  /// Prints what is new since the last call.
  void report(NetLink& link, const SimLoop& loop, bool paused);

 private:
  void report_paused(bool paused);
  void report_holders(const NetLink& link, bool paused);
  void report_beyond(const SimLoop& loop);
  void report_mismatch(NetLink& link);
  void report_end(const SimLoop& loop);

  const Scene& scene_;
  bool paused_ = false, at_end_ = false;
  std::vector<bool> held_, beyond_;
  std::array<int, 3> unsaid_{};  // calls, of each kind of mismatch, until it is said again
};

/// Returns what a report of a run (REPORT.md) says of the priority of its threads: that other programs can
/// make forces older where they had none. Empty where they had it.
std::string real_time_text(const Json& report);

}  // namespace palpate::sim
