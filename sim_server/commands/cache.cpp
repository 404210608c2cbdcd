#include "sim_server/commands/cache.h"

#include <cstdlib>

#include "common/error.h"
#include "common/log.h"
#include "sim_server/models/deformation_models.h"

namespace palpate::sim {
namespace {

/// $XDG_CACHE_HOME/palpate, else ~/.cache/palpate; nothing where neither is known.
std::optional<std::filesystem::path> usual_folder() {
  using std::filesystem::path;
  const char *const cache = std::getenv("XDG_CACHE_HOME"), *const home = std::getenv("HOME");
  if (cache != nullptr && path(cache).is_absolute()) return path(cache) / "palpate";
  if (home != nullptr && path(home).is_absolute()) return path(home) / ".cache" / "palpate";
  return {};
}

}  // namespace

std::optional<SetupCache> open_cache(const CacheOptions& options) {
  if (options.none) return {};
  const auto folder = options.folder ? options.folder : usual_folder();
  if (folder) return SetupCache(*folder);
  log::warning("no set-up cache: neither $XDG_CACHE_HOME nor $HOME names a folder; --cache DIR does");
  return {};
}

std::optional<Condensed> open_condensed(const CacheOptions& options, const Scene& scene) {
  if (!options.condensed) return {};
  if (!model_of(scene.deformation).condenses)
    fail("--condensed: nothing of tissue of model \"{}\" ({}) is condensed; leave it out",
         scene.deformation.model, scene.deformation.where);
  return Condensed(*options.condensed);
}

std::vector<Option> cache_or_none(CacheOptions& options, const std::string& needs) {
  return {{"--cache",
           "Folder that keeps what set-ups computed (default: $XDG_CACHE_HOME/palpate, or ~/.cache/palpate)",
           &options.folder,
           {.needs = needs}},
          {"--no-cache", "Compute everything anew, and keep nothing", &options.none, {.needs = needs}}};
}

std::vector<Option> cache_options(CacheOptions& options, const std::string& needs) {
  return joined({cache_or_none(options, needs),
                 {{"--condensed",
                   "Folder that `sim_server condense` made of this scene: set up from it",
                   &options.condensed,
                   {.needs = needs}}}});
}

}  // namespace palpate::sim
