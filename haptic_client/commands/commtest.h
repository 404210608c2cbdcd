#pragma once
#include <filesystem>
#include <optional>

#include "common/program.h"
#include "haptic_client/session/client_config.h"

namespace palpate::client {

/// What `haptic_client commtest` was asked for.
struct CommtestOptions {
  double seconds = 10;  ///< of the test
  double wait = 5;      ///< s, for the server to answer
  std::optional<std::filesystem::path> json;
};

/// Tests the link to `config.server`: a session as `run` would have it, with a simulated hand on the client
/// file's motion in the place of its device, and beside it five round trips a second (`LinkProbe`) that need
/// no session. Prints what it measured and a verdict from the stability study. Throws `Error`. Returns 0
/// (PASS, WARN) or 1 (FAIL).
int test_link(const ClientConfig& config, const CommtestOptions& options);

/// Tests the loop of a device in the same way: reads it and writes zero force at its rate. Throws `Error`.
/// Returns 0, or 1 where nothing usable came.
int test_device(const ClientConfig& config, const CommtestOptions& options);

/// `haptic_client commtest`.
Command commtest_command();

}  // namespace palpate::client
