#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/types.h"

namespace palpate {
class Config;
}

namespace palpate {

/// File of a recorded motion, and how to read it.
struct TrajectorySettings {
  std::filesystem::path file;
  std::array<std::string, 4> columns{"t_s", "x_m", "y_m", "z_m"};  ///< time (s) and position
  /// Name of the column of the device's buttons that are down from each row on, [0, 65535]; without it none
  /// is down.
  static constexpr const char* kButtons = "buttons";
  double scale = 1;              ///< metres per unit of the position columns
  Vec3 offset = Vec3::Zero();    ///< added after scaling, m
  bool repeat = false;           ///< after its end from the start again; it must end within 1 mm of that
  Mat3 axes = Mat3::Identity();  ///< turns the columns; not a key of the file
};

/// Reads a `[trajectory]` section: file, columns, scale, offset, repeat. Throws `Error`.
TrajectorySettings read_trajectory_settings(const Config& section);

/// A path through space: straight between rows, at rest before the first and after the last, or
/// then from the start again. m, s, in the frame of the settings.
class Trajectory {
 public:
  /// Reads a CSV. Throws `Error` for a bad row (file and line), times that do not increase (file and row), or
  /// a motion that is to repeat and ends elsewhere than it began.
  explicit Trajectory(const TrajectorySettings& settings);
  /// Takes rows, times increasing; for tests and for a hand that does not move (one row).
  Trajectory(std::vector<double> t_s, std::vector<Vec3> p, bool repeats = false);

  /// Position at `t` seconds after the start. O(log rows), no allocation.
  Vec3 at(double t) const noexcept;
  /// Buttons pressed then; 0: none.
  std::uint16_t buttons_at(double t) const noexcept;
  /// Rows a second, on average; 0 with one row.
  double rate_hz() const noexcept {
    return duration() > 0 ? static_cast<double>(t_.size() - 1) / duration() : 0;
  }
  double duration() const noexcept { return t_.back() - t_.front(); }

 private:
  double time_in_rows(double t) const noexcept;

  std::vector<double> t_;
  std::vector<Vec3> p_;
  std::vector<std::uint16_t> buttons_;  // of each row, or none at all
  bool repeats_;
};

}  // namespace palpate
