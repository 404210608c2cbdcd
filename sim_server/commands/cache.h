#pragma once
#include <filesystem>
#include <optional>

#include "sim_server/setup_cache/setup_cache.h"

namespace palpate::sim {

/// `--cache DIR` and `--no-cache`.
struct CacheOptions {
  std::optional<std::filesystem::path> folder;  ///< absent: the usual one
  bool none = false;
};

/// Nothing with `--no-cache`, or where no folder is known.
std::optional<SetupCache> open_cache(const CacheOptions& options);

/// Prints the entries, the one used last first. Returns the exit code.
int list_cache(const CacheOptions& options);
/// Removes them all, and says how much. Returns the exit code.
int clear_cache(const CacheOptions& options);

}  // namespace palpate::sim
