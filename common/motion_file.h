#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/workspace.h"

namespace palpate {

/// File of a recorded motion, and how to read it. Lengths in m, in the world.
struct TrajectorySettings {
  std::filesystem::path file;
  std::vector<std::string> columns{};  ///< of time, x, y and z; without time with `rate_hz`; none: by name
  std::optional<double> scale{};       ///< m per unit of the position columns; absent: by their names
  Vec3 offset = Vec3::Zero();          ///< added after scaling, m
  bool repeat = false;                 ///< after its end from the start again; it must end within 1 mm of it
  Mat3 axes = Mat3::Identity();        ///< a rotation: rows are the world's axes in the frame of the file
  std::optional<double> time_scale{};  ///< s per unit of the time column; absent: by its name
  std::optional<double> rate_hz{};     ///< rows a second of a file without a time column
  std::optional<double> gap{};         ///< longest accepted time between two rows, s
  Workspace frame{};                   ///< of a device, where its path is wanted instead of the world's
};

/// Reads a `[trajectory]` section. Throws `Error`.
TrajectorySettings read_trajectory_settings(const Config& section);

/// Returns how to read a motion: a CSV with the usual columns, or what the [trajectory] of a client file
/// (.toml) names. Throws `Error`.
TrajectorySettings motion_settings(const std::filesystem::path& file);

/// Rows of a recorded motion, in the frame of the settings.
struct MotionRows {
  std::vector<double> t;                 ///< s, increasing
  std::vector<Vec3> p{};                 ///< m
  std::vector<Quat> q{};                 ///< unit, each in the hemisphere of the one before; none: not turned
  std::vector<std::uint16_t> buttons{};  ///< down from each row on; none: no button is
  std::string summary{};                 ///< one line: what the file was taken for, with units
  std::vector<std::string> warnings{};   ///< one line each
};

/// Reads a motion. Orientation is in columns qw, qx, qy and qz (unit quaternion), pressed buttons in column
/// buttons (bits). Throws `Error` with file and line for a bad row, times that do not increase, a time
/// between rows that is longer than `gap` (by default ten times the usual one), one row or more, of at most
/// half a second, farther from those around than a hand accelerates, a speed above 10 m/s, or times that look
/// like milliseconds read as seconds. A file of fewer than 20 rows is taken for corners of a path: its times
/// may be any, and its steps as long as that speed permits.
MotionRows read_motion_rows(const TrajectorySettings& settings);

}  // namespace palpate
