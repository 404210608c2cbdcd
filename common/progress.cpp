#include "common/progress.h"

#include <algorithm>
#include <cstdio>
#include <fmt/core.h>
#include <unistd.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;
// Before the first estimate; between two lines on a terminal; in a file.
constexpr Time kFirstEstimate = 2s, kTerminalPeriod = 1s, kLinePeriod = 10s;

}  // namespace

std::string time_remaining(double fraction, Time elapsed) {
  if (!(fraction > 0) || fraction >= 1 || elapsed < kFirstEstimate) return "";
  const double seconds = to_seconds(elapsed) * (1 - fraction) / fraction;
  if (seconds >= 5400) return fmt::format(", about {:.1f} hours left", seconds / 3600);
  if (seconds >= 90) return fmt::format(", about {:.0f} minutes left", seconds / 60);
  return fmt::format(", about {:.0f} s left", seconds);
}

void ProgressLine::operator()(std::string_view stage, double fraction) {
  if (wait_for_interrupt(Time::zero()))
    fail_at_run_time("interrupted while {}; {}", stage, when_interrupted_);
  const Time time = now();
  const bool new_stage = stage != stage_;
  if (new_stage) began_ = published_ = time;
  const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
  const std::string remaining = percent < 100 ? time_remaining(fraction, time - began_) : "";
  if (isatty(STDERR_FILENO) != 0) {
    if (!new_stage && percent == shown_ && (percent == 100 || time - published_ < kTerminalPeriod)) return;
    fmt::print(stderr, "\r\033[K{} {:3} %{}{}", stage, percent, remaining, percent == 100 ? "\n" : "");
  } else if (new_stage) {
    fmt::print(stderr, "{} ...\n", stage);
  } else if (percent < 100 && time - published_ >= kLinePeriod) {
    fmt::print(stderr, "{}: {} %{}\n", stage, percent, remaining);
  } else {
    return;
  }
  std::fflush(stderr);
  stage_ = stage;
  shown_ = percent;
  published_ = time;
}

}  // namespace palpate
