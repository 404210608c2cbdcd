#pragma once
#include <filesystem>
#include <vector>

#include "haptic_client/loop/haptic_loop.h"

namespace palpate::client {

/// Writes recorded ticks as CSV, a row a tick: `t_s`, `p{x,y,z}_m` (world), `f{x,y,z}_n` (written, device
/// frame), `sample_n` (|F_n| where a sample arrived, at its own time `sample_t_s`; empty elsewhere), then
/// `<law>_n`, the magnitude each of `laws` gives on the same samples and motion. Whole file or none; throws
/// `Error`. Not for a running loop.
void write_trace(const std::filesystem::path& file, const std::vector<TickRecord>& ticks,
                 const std::vector<std::string>& laws);

}  // namespace palpate::client
