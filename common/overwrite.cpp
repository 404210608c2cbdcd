#include "common/overwrite.h"

#include "common/error.h"

namespace palpate {

Option force_option(bool& force) {
  return {"--force", "Overwrite captures and CSV files that are there already", &force};
}

void require_new(const std::vector<NamedFile>& files, bool force) {
  if (force) return;
  for (const NamedFile& named : files) {
    if (!named.file) continue;
    std::error_code none;
    const std::string place = std::filesystem::absolute(*named.file, none).lexically_normal().string();
    const bool of_the_system = place.starts_with("/dev/") || place.starts_with("/proc/");
    if (of_the_system || !std::filesystem::is_regular_file(*named.file, none)) continue;
    if (std::filesystem::file_size(*named.file, none) > 0)
      fail("{}: {} is there already; `--force` overwrites it, another name keeps it", named.option,
           named.file->string());
  }
}

}  // namespace palpate
