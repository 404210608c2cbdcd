#include "common/files.h"

#include "common/error.h"

namespace palpate {

void require_file(const std::filesystem::path& path, const char* content) {
  std::error_code failed;
  const std::filesystem::file_status status = std::filesystem::status(path, failed);
  if (!std::filesystem::exists(status)) fail("{}: no such file", path.string());
  if (std::filesystem::is_directory(status)) fail("{}: is a folder; name {} in it", path.string(), content);
  if (!std::filesystem::is_regular_file(status))
    fail("{}: is no file, but a pipe or a device; write what it gives to a file first", path.string());
}

}  // namespace palpate
