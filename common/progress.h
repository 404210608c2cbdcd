#pragma once
#include <string>
#include <string_view>

#include "common/time.h"

namespace palpate {

/// Returns the remaining time of work of which the fraction `fraction` (0 to 1) took `elapsed`, at a constant
/// rate: ", about 50 s left". Empty within the first 2 s, and for `fraction` 0 or 1.
std::string time_remaining(double fraction, Time elapsed);

/// Tells on stderr how long work goes on: on a terminal one running line with a percentage, elsewhere one
/// line a stage and one every 10 s that it lasts; both with the time left. Call it with the name of the stage
/// and the share of it that is done (0 to 1), as often as you like; 1 ends a stage. Ctrl-C ends the work
/// here, by an `Error` (run time) that ends with what that means. Main thread.
class ProgressLine {
 public:
  explicit ProgressLine(std::string when_interrupted = "nothing was written")
      : when_interrupted_(std::move(when_interrupted)) {}
  void operator()(std::string_view stage, double fraction);

 private:
  std::string when_interrupted_, stage_;
  int shown_ = -1;              // percent
  Time began_{}, published_{};  // the stage; the last line
};

}  // namespace palpate
