#include "common/report.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <unistd.h>

#include "common/error.h"

namespace palpate {
namespace fs = std::filesystem;

Json quantiles(const Histogram& histogram, double unit_ns) {
  return {{"p50", histogram.quantile(0.5) / unit_ns},
          {"p99", histogram.quantile(0.99) / unit_ns},
          {"p999", histogram.quantile(0.999) / unit_ns},
          {"max", static_cast<double>(histogram.max()) / unit_ns}};
}

namespace {
fs::path temporary_beside(const fs::path& file) {
  fs::path temporary = file;
  temporary += fmt::format(".{}.part", getpid());
  return temporary;
}
}  // namespace

void check_writable(const fs::path& file) {
  const fs::path temporary = temporary_beside(file);
  std::error_code ignored;
  const bool usable = !fs::is_directory(file, ignored) && std::ofstream(temporary).good();
  fs::remove(temporary, ignored);
  if (!usable) fail("{}: cannot be written; name a file in a folder that exists and is yours", file.string());
}

void write_whole(const fs::path& file, const std::string& text) {
  const fs::path temporary = temporary_beside(file);
  std::error_code failed;
  {
    std::ofstream out(temporary, std::ios::binary);
    out << text << std::flush;
    if (!out) failed = std::make_error_code(std::errc::io_error);
  }
  if (!failed) fs::rename(temporary, file, failed);
  if (!failed) return;
  std::error_code ignored;
  fs::remove(temporary, ignored);
  fail_at_run_time("{}: could not be written ({}); is the disk full?", file.string(), failed.message());
}

void write_json(const fs::path& file, const Json& json) {
  write_whole(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace palpate
