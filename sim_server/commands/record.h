#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "common/program.h"
#include "sim_server/commands/cache.h"

namespace palpate::sim {

/// Options of `sim_server record`.
struct RecordOptions {
  std::filesystem::path scene, out;
  std::vector<std::filesystem::path> trajectories;  ///< of the tools of the scene, in order
  std::size_t tool = 1;  ///< whose session stands first in the capture and in the figures, from 1
  double rate_hz = 30;   ///< steps a second, [1, 20000]
  double delay_ms = 0;   ///< from reading the tool to having its force in the client, ms, [0, 10000]
  std::optional<double> ticks_hz;  ///< tool states a second, at least `rate_hz`; absent: 500 or `rate_hz`
  std::optional<double> seconds;   ///< absent: the motion of that tool once
  bool parts = true;       ///< whether the samples carry all they can: tangents, surface, a second place
  bool real_time = false;  ///< whether steps take as long as they do, at the pace of the clock
  std::optional<std::filesystem::path> report;
  std::optional<std::filesystem::path> resection;  ///< CSV of what was removed
  /// CSV (t_s, tetrahedron) of the tetrahedra that went; and one of those that are to go, instead of by heat.
  std::optional<std::filesystem::path> removals, remove;
  bool force = false;  ///< overwrites files that are there
  CacheOptions cache;
};

/// Runs a scene in virtual time along recorded motions and writes what would have travelled as a capture:
/// the same simulation, sessions and bytes as `run`, without sockets and clock, as fast as they go. Virtual
/// time begins at 0; step n answers the newest tool state at n / rate, and its sample is in the client
/// `delay` after that tool state was read, in `real_time` that much after its step is done. The same
/// arguments give the same bytes, but in `real_time`. Throws `Error`. Returns the exit code.
int record(const RecordOptions& options);

/// `sim_server record`.
Command record_command();

}  // namespace palpate::sim
