#pragma once
#include <filesystem>
#include <optional>

#include "common/program.h"
#include "sim_server/scene/scene.h"
#include "sim_server/setup_cache/condensed.h"
#include "sim_server/setup_cache/setup_cache.h"

namespace palpate::sim {

/// `--cache DIR`, `--no-cache` and `--condensed DIR`.
struct CacheOptions {
  std::optional<std::filesystem::path> folder;  ///< absent: the usual one
  bool none = false;
  std::optional<std::filesystem::path> condensed;
};

/// Nothing with `--no-cache`, or where no folder is known.
std::optional<SetupCache> open_cache(const CacheOptions& options);

/// Returns the folder from which a session of `scene` takes its set-up, with `--condensed`. Throws `Error`
/// where that is no folder, or a scene of this model is not condensed.
std::optional<Condensed> open_condensed(const CacheOptions& options, const Scene& scene);

/// `--cache` and `--no-cache`; `needs`: option without which they are no use, if not empty.
std::vector<Option> cache_or_none(CacheOptions& options, const std::string& needs = {});
/// `--cache`, `--no-cache` and `--condensed`.
std::vector<Option> cache_options(CacheOptions& options, const std::string& needs = {});

}  // namespace palpate::sim
