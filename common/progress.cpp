#include "common/progress.h"

#include <algorithm>
#include <cstdio>
#include <fmt/core.h>
#include <unistd.h>

#include "common/error.h"
#include "common/interrupt.h"

namespace palpate {

void ProgressLine::operator()(std::string_view stage, double share) {
  if (wait_for_interrupt(Time::zero()))
    fail_at_run_time("interrupted while {}; {}", stage, when_interrupted_);
  const int percent = static_cast<int>(100 * std::clamp(share, 0.0, 1.0));
  const bool new_stage = stage != stage_;
  if (!new_stage && percent == shown_) return;
  if (isatty(STDERR_FILENO) != 0) {
    fmt::print(stderr, "\r\033[K{} {:3} %{}", stage, percent, percent == 100 ? "\n" : "");
  } else if (new_stage) {
    fmt::print(stderr, "{} ...\n", stage);
  }
  std::fflush(stderr);
  stage_ = stage;
  shown_ = percent;
}

}  // namespace palpate
