#pragma once
#include <filesystem>
#include <optional>

#include "common/program.h"
#include "haptic_client/evaluation/captured_session.h"
#include "haptic_client/session/client_config.h"

namespace palpate::client {

/// Options of `haptic_client replay`, beyond the configuration. Of that, method, workspace, limits and laws
/// to score count; its server and device do not.
struct ReplayOptions {
  std::filesystem::path capture;
  std::optional<double> rate_hz;  ///< ticks a second; absent, or within 2 % of the capture's: its own ticks
  std::string client;             ///< file of the client; empty: all defaults
  std::optional<int> session;     ///< from 1, as listed; absent: the longest
  std::optional<std::filesystem::path> out;     ///< CSV, a row a tick
  std::optional<std::filesystem::path> report;  ///< JSON
};

/// Plays the tool of a captured session to the live server of `config`, in real time, through pipeline and
/// link as `run` does; the force is computed, written to `out` and the report, and moves nothing. Throws
/// `Error`. Returns the exit code.
int replay_live(const ClientConfig& config, const ReplayOptions& options);

/// Contents of a capture, and which of its sessions is selected.
struct ChosenSession {
  CaptureSurvey found;
  std::size_t index = 0;
  const CapturedRun& run() const { return found.runs[index]; }
};
/// Reads the capture through: the session asked for, or the longest; says which when there are several, and
/// what is wrong with the file. Throws `Error`, also where what is to be written cannot be.
ChosenSession choose_session(const ReplayOptions& options);

/// The rate that the client was asked for, if that of the capture (which may have missed ticks) is near it;
/// in any case one that a loop can have. Hz.
double nominal_rate(double captured_hz, double requested_hz);

/// Runs the ticks of a captured session through law, watchdog and limiter again, offline: the same forces,
/// bit by bit, whenever it is done. Throws `Error`. Returns the exit code.
int replay(const ClientConfig& config, const ReplayOptions& options);

/// `haptic_client replay`.
Command replay_command();

}  // namespace palpate::client
