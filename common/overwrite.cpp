#include "common/overwrite.h"

#include "common/error.h"
#include "common/log.h"

namespace palpate {
namespace {

/// A name that no file has.
std::filesystem::path free_name(const std::filesystem::path& file) {
  for (int number = 1;; ++number) {
    const std::filesystem::path name = fmt::format("{}.~{}~", file.string(), number);
    std::error_code none;
    if (!std::filesystem::exists(std::filesystem::symlink_status(name, none))) return name;
  }
}

bool holds_something(const std::filesystem::path& file) {
  std::error_code none;
  const std::string place = std::filesystem::absolute(file, none).lexically_normal().string();
  const bool of_the_system = place.starts_with("/dev/") || place.starts_with("/proc/");
  return !of_the_system && std::filesystem::is_regular_file(file, none) &&
         std::filesystem::file_size(file, none) > 0;
}

}  // namespace

Option force_option(bool& force) {
  return {"--force", "Overwrite captures and CSV files that are there; else they are kept as FILE.~1~ ...",
          &force};
}

void set_aside(const std::vector<NamedFile>& files, bool force) {
  if (force) return;
  for (const NamedFile& named : files) {
    if (!named.file || !holds_something(*named.file)) continue;
    std::error_code failed;
    const std::filesystem::path file = std::filesystem::canonical(*named.file, failed);  // links stay
    const std::filesystem::path kept = free_name(*named.file);
    if (!failed) std::filesystem::rename(file, kept, failed);
    if (failed) {
      fail_at_run_time("{}: {} is there, and cannot be kept as {} ({}); `--force` overwrites it",
                       named.option, named.file->string(), kept.string(), failed.message());
    }
    log::info("{}: what was there is kept as {} (`--force` overwrites it)", named.file->string(),
              kept.string());
  }
}

}  // namespace palpate
