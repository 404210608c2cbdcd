#pragma once
#include <filesystem>
#include <optional>

#include "common/program.h"

namespace palpate::sim {

struct CondenseOptions {
  std::filesystem::path scene, out;
  std::optional<std::filesystem::path> report;
};

/// Computes what the set-up of a large body takes long for, on all ranks of MPI, and keeps it in the folder
/// `out`, from which `run`, `record` and `view` take it (`--condensed`). What is there already stays.
/// Returns the exit code. Throws `Error`; in a build without MPI, always.
int condense(const CondenseOptions& options);

/// `sim_server condense`.
Command condense_command();

}  // namespace palpate::sim
