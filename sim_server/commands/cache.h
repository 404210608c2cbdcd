#pragma once
#include <filesystem>
#include <optional>

#include "common/program.h"
#include "sim_server/scene/scene.h"
#include "sim_server/setup_cache/condensed.h"
#include "sim_server/setup_cache/setup_cache.h"

namespace palpate::sim {

/// `--cache DIR` and `--no-cache`.
struct CacheOptions {
  std::optional<std::filesystem::path> folder;  ///< absent: the usual one
  bool none = false;
  std::optional<std::filesystem::path> condensed;  ///< `--condensed DIR`
};

/// Nothing with `--no-cache`, or where no folder is known.
std::optional<SetupCache> open_cache(const CacheOptions& options);

/// Returns the folder from which a session of `scene` takes its set-up, with `--condensed`. Throws `Error`
/// where that is no folder, or a scene of this model is not condensed.
std::optional<Condensed> open_condensed(const CacheOptions& options, const Scene& scene);

/// Prints the entries, the one used last first. Returns the exit code.
int list_cache(const CacheOptions& options);
/// Removes them all, and says how much. Returns the exit code.
int clear_cache(const CacheOptions& options);

/// `--cache`.
std::vector<Option> cache_option(CacheOptions& options);
/// `--cache`, `--no-cache` and `--condensed`, where they are no use without the option `needs`, if one is
/// named.
std::vector<Option> cache_options(CacheOptions& options, const std::string& needs = {});
/// `--cache` and `--no-cache`.
std::vector<Option> cache_or_none(CacheOptions& options, const std::string& needs = {});

/// `sim_server cache`.
Command cache_command();

}  // namespace palpate::sim
