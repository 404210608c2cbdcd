#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/program.h"

namespace palpate::client {

/// Options of `haptic_client evaluate`.
struct EvaluateOptions {
  std::vector<std::filesystem::path> captures;
  std::optional<std::filesystem::path> truth;  ///< absent: the force between the samples (`BetweenSamples`)
  std::filesystem::path out;                   ///< folder; made if it is not there
  std::vector<std::string> methods;            ///< empty: every law there is
  std::string world;                           ///< name of what was touched; empty: the name of the capture
  double blend_ms = 10;                        ///< of the blended rows, (0, 100]
  std::uint64_t keep = 1;  ///< laws get one sample of so many, the first to begin with, [1, 1000]
  double compliance = 1;   ///< the surface model that laws see is so many times as compliant, [0.01, 100]
};

/// Runs every law on the captures (the longest session of each), as it is and blended, and scores it at the
/// ticks against the truth: a row each in `summary.json` and `summary.csv`. The same input gives the same
/// bytes but for the timing columns. Throws `Error`. Returns the exit code.
int evaluate(const EvaluateOptions& options);

/// `haptic_client evaluate`.
Command evaluate_command();

}  // namespace palpate::client
