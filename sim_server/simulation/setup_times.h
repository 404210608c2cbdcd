#pragma once
#include <string>
#include <vector>

#include "common/clock.h"
#include "common/report.h"
#include "sim_server/tissue/model_inputs.h"

namespace palpate::sim {

/// Duration of each stage of a set-up: a `Progress` (pass it by `std::ref`) that hands every call on and
/// counts the time from one call to the next for the stage that the first of them named. One thread.
class SetupTimes {
 public:
  /// `report`: who else wants to know. `clock`: what to ask for the time; for tests.
  explicit SetupTimes(Progress report = {}, Time (*clock)() = &now);

  void operator()(std::string_view what, double fraction);

  struct Stage {
    std::string name;
    Time took;
  };
  /// Returns the stages in the order of their start; the newest is complete once the next one, or its own
  /// end, was reported.
  const std::vector<Stage>& stages() const { return stages_; }
  /// Time spent in the stage called `what`; zero if there was none.
  Time of(std::string_view what) const;
  /// Returns the duration of all stages together.
  Time total() const;
  /// {stage: milliseconds}.
  Json to_json() const;

 private:
  Stage& stage(std::string_view what);

  Progress report_;
  Time (*clock_)();
  std::vector<Stage> stages_;
  std::string current_;  // stage; empty before the first
  Time last_ = Time::zero();
};

}  // namespace palpate::sim
