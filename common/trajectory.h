#pragma once
#include "common/motion_file.h"

namespace palpate {

/// A path through space: straight between rows, at rest before the first and after the last, or
/// then from the start again. m, s, in the frame of the settings.
class Trajectory {
 public:
  /// Reads a file (`read_motion_rows`). Throws `Error` as that does, or for a motion that is to repeat and
  /// ends elsewhere than it began.
  explicit Trajectory(const TrajectorySettings& settings);
  /// Takes rows, times increasing; for tests and for a hand that does not move (one row).
  Trajectory(std::vector<double> t_s, std::vector<Vec3> p, bool repeats = false);

  /// Position at `t` seconds after the start. O(log rows), no allocation.
  Vec3 at(double t) const noexcept;
  /// True if the rows have an orientation.
  bool turns() const noexcept { return !rows_.q.empty(); }
  /// Orientation then, unit: on the shortest way between rows at an even rate; none where `turns` is false.
  Quat orientation_at(double t) const noexcept;
  /// Buttons pressed then; 0: none.
  std::uint16_t buttons_at(double t) const noexcept;
  /// Rows a second, on average; 0 with one row.
  double rate_hz() const noexcept {
    return duration() > 0 ? static_cast<double>(rows_.t.size() - 1) / duration() : 0;
  }
  double duration() const noexcept { return rows_.t.back() - rows_.t.front(); }
  /// Logs what the file was taken for, and warnings, a line each.
  void log_source() const;

 private:
  /// Place of a time between two rows: `fraction` of the way from `row` to the next.
  struct Between {
    std::size_t row;
    double fraction;
  };
  double time_in_rows(double t) const noexcept;
  Between between(double t) const noexcept;

  MotionRows rows_;
  bool repeats_;
};

}  // namespace palpate
