#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "common/program.h"
#include "sim_server/commands/listening.h"

namespace palpate::sim {

/// Options of `sim_server replay`.
struct ReplayOptions {
  std::filesystem::path capture;
  ListenOptions listen;
  std::optional<double> seconds;  ///< stop after so long; absent: when it has been played, or at Ctrl-C
};

/// Plays the forces of a captured session to a live client and its device. Throws `Error`. Returns 0.
int serve_replay(const ReplayOptions& options);

/// `sim_server replay`.
Command replay_command();

}  // namespace palpate::sim
