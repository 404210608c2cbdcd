#pragma once
#include <string>
#include <string_view>

namespace palpate {

/// Tells on stderr how long work goes on: on a terminal one running line with a percentage, elsewhere one
/// line a stage. Call it with the name of the stage and the share of it that is done (0 to 1), as often as
/// you like; 1 ends a stage. Ctrl-C ends the work here, by an `Error` (run time). Main thread.
class ProgressLine {
 public:
  void operator()(std::string_view stage, double share);

 private:
  std::string stage_;
  int shown_ = -1;  // percent
};

}  // namespace palpate
