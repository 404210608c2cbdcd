#include "sim_server/setup_cache/condensed.h"

#include <unistd.h>

#include "common/error.h"

namespace palpate::sim {

Condensed::Condensed(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code failed;
  if (!std::filesystem::is_directory(folder_, failed))
    fail("--condensed: \"{}\" is no folder; `sim_server condense SCENE --out {}` makes it", folder_.string(),
         folder_.string());
}

Condensed::Condensed(std::filesystem::path folder, MakeFactor make_factor)
    : folder_(std::move(folder)), make_factor_(std::move(make_factor)) {
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  if (!failed && access(folder_.c_str(), W_OK) != 0) failed = {errno, std::generic_category()};
  if (failed) fail("--out: cannot keep anything in \"{}\": {}", folder_.string(), failed.message());
}

std::optional<MappedMatrix> Condensed::find(const Digest& key, const std::string& what,
                                            const std::string& scene) const {
  try {
    if (auto found = map_entry(entry_file(folder_, key), key)) return found;
  } catch (const Error& error) {
    fail("{}; remove it and condense the scene again", error.what());
  }
  if (!make_factor_)
    fail(
        "--condensed: \"{}\" holds no {} of {}: its mesh, material, [[fixed]], `reach` or model is another; "
        "`sim_server condense {} --out {}` makes them",
        folder_.string(), what, scene, scene, folder_.string());
  return {};
}

}  // namespace palpate::sim
