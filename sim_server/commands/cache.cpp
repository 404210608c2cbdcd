#include "sim_server/commands/cache.h"

#include <chrono>
#include <fmt/core.h>
#include <memory>

#include "common/error.h"
#include "common/log.h"
#include "common/memory_budget.h"
#include "sim_server/models/deformation_models.h"

namespace palpate::sim {
namespace {

SetupCache known_cache(const CacheOptions& options) {
  const auto folder = options.folder ? options.folder : SetupCache::usual_folder();
  if (!folder) fail("cache: neither $XDG_CACHE_HOME nor $HOME names a folder; name one with --cache DIR");
  return SetupCache(*folder);
}

double hours_since(std::filesystem::file_time_type then) {
  return std::chrono::duration<double, std::ratio<3600>>(std::filesystem::file_time_type::clock::now() - then)
      .count();
}

}  // namespace

std::optional<SetupCache> open_cache(const CacheOptions& options) {
  if (options.none) return {};
  if (!options.folder && !SetupCache::usual_folder()) {
    log::warning("no set-up cache: neither $XDG_CACHE_HOME nor $HOME names a folder; --cache DIR does");
    return {};
  }
  return known_cache(options);
}

std::optional<Condensed> open_condensed(const CacheOptions& options, const Scene& scene) {
  if (!options.condensed) return {};
  if (!model_of(scene.deformation).condenses)
    fail("--condensed: nothing of tissue of model \"{}\" ({}) is condensed; leave it out",
         scene.deformation.model, scene.deformation.where);
  return Condensed(*options.condensed);
}

int list_cache(const CacheOptions& options) {
  const SetupCache cache = known_cache(options);
  double bytes = 0;
  const auto entries = cache.list();
  for (const SetupCache::Entry& entry : entries) {
    bytes += entry.bytes;
    fmt::print("  {:<52}  {:>9}  saves {:>6.1f} s  used {:.1f} h ago\n",
               entry.header ? entry.header->what : entry.file.filename().string() + " (spoilt)",
               bytes_text(entry.bytes), entry.header ? entry.header->seconds : 0.0, hours_since(entry.used));
  }
  fmt::print("{}: {} entries, {}\n", cache.folder().string(), entries.size(), bytes_text(bytes));
  return 0;
}

int clear_cache(const CacheOptions& options) {
  const SetupCache cache = known_cache(options);
  const auto [count, bytes] = cache.clear();
  fmt::print("{}: {} files removed, {}\n", cache.folder().string(), count, bytes_text(bytes));
  return 0;
}

std::vector<Option> cache_option(CacheOptions& options) {
  return {{"--cache",
           "Folder that keeps what set-ups computed (default: $XDG_CACHE_HOME/palpate, or ~/.cache/palpate)",
           &options.folder}};
}

std::vector<Option> cache_or_none(CacheOptions& options, const std::string& needs) {
  std::vector<Option> both = cache_option(options);
  both.push_back({"--no-cache", "Compute everything anew, and keep nothing", &options.none});
  for (Option& option : both) option.rules.needs = needs;
  return both;
}

std::vector<Option> cache_options(CacheOptions& options, const std::string& needs) {
  return joined({cache_or_none(options, needs),
                 {{"--condensed",
                   "Folder that `sim_server condense` made of this scene: set up from it",
                   &options.condensed,
                   {.needs = needs}}}});
}

Command cache_command() {
  const auto options = std::make_shared<CacheOptions>();
  return {.name = "cache",
          .summary = "What set-ups have computed, kept on disk",
          .footer = "Examples: sim_server cache list\n          sim_server cache clear",
          .commands = {{.name = "list",
                        .summary = "What is kept, how large it is, and what it saves",
                        .footer = "Example: sim_server cache list",
                        .options = cache_option(*options),
                        .run = [options] { return list_cache(*options); }},
                       {.name = "clear",
                        .summary = "Remove all of it; the next set-ups compute it again",
                        .footer = "Example: sim_server cache clear",
                        .options = cache_option(*options),
                        .run = [options] { return clear_cache(*options); }}}};
}

}  // namespace palpate::sim
