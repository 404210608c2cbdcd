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

WholeFile::WholeFile(const fs::path& file) : file_(file), part_(file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (!fs::exists(status) || fs::is_regular_file(status)) part_ += fmt::format(".{}.part", getpid());
  if (fs::is_directory(status) || !std::ofstream(part_).good()) {
    fail("{}: cannot be written; name a file in a folder that exists and is yours", file.string());
  }
}

WholeFile::~WholeFile() {
  std::error_code ignored;
  if (part_ != file_) fs::remove(part_, ignored);
}

void WholeFile::commit() {
  std::error_code failed;
  if (part_ != file_) fs::rename(part_, file_, failed);
  if (failed) fail_at_run_time("{}: could not be written ({})", file_.string(), failed.message());
}

void check_writable(const fs::path& file) {
  const WholeFile probe(file);
}

void write_whole(const fs::path& file, const std::string& text) {
  WholeFile whole(file);
  std::ofstream out(whole.path(), std::ios::binary);
  out << text << std::flush;
  if (!out) fail_at_run_time("{}: could not be written; is the disk full?", file.string());
  whole.commit();
}

void write_json(const fs::path& file, const Json& json) {
  write_whole(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace palpate
