#include "common/report.h"

#include <array>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <unistd.h>

#include "common/error.h"
#include "common/renamed_keys.h"

namespace palpate {
namespace fs = std::filesystem;

Json quantiles(const Histogram& histogram, double unit_ns) {
  return {{"p50", histogram.quantile(0.5) / unit_ns},
          {"p99", histogram.quantile(0.99) / unit_ns},
          {"p999", histogram.quantile(0.999) / unit_ns},
          {"max", static_cast<double>(histogram.max()) / unit_ns}};
}

namespace {

/// Returns what a path leads to, also where the last link dangles.
fs::path without_links(fs::path file) {
  constexpr int kMostLinks = 40;  // as Linux follows at most (ELOOP)
  std::error_code failed;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(file, failed)); ++i)
    file = file.parent_path() / fs::read_symlink(file, failed);
  const fs::path target = fs::weakly_canonical(file, failed);
  return failed ? file : target;
}

/// Devices and pipes; also /dev/stdout, which is a link to whatever the output goes to.
bool written_directly(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  const std::string place = fs::absolute(file, ignored).lexically_normal().string();
  const bool of_the_system = place.rfind("/dev/", 0) == 0 || place.rfind("/proc/", 0) == 0;
  return (of_the_system && fs::is_symlink(fs::symlink_status(file, ignored))) ||
         (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status));
}

struct Kind {
  const char* extension;
  const char* what;
  std::optional<Contents> contents;  ///< none: nothing of ours writes such files
};

constexpr std::array<Kind, 7> kKinds{{{".toml", "a scene or a client file", {}},
                                      {".msh", "a mesh", {}},
                                      {".csv", "a table or a motion", Contents::kTable},
                                      {".json", "a report", Contents::kReport},
                                      {".pcap", "a capture", Contents::kCapture},
                                      {".vtu", "a mesh for ParaView", Contents::kShapes},
                                      {".pvd", "a series for ParaView", Contents::kShapes}}};

/// A file that is there keeps its place where its name says that it is of another kind. A link is as what it
/// points to.
void refuse_another_kind(const fs::path& file, const fs::path& target, Contents contents) {
  std::error_code ignored;
  if (!fs::is_regular_file(target, ignored)) return;
  for (const Kind& kind : kKinds) {
    if (target.extension() == kind.extension && kind.contents != contents)
      fail("{}: is there already, by its name as {}, which would be lost; name another file", file.string(),
           kind.what);
  }
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& file, Contents contents)
    : file_(written_directly(file) ? file : without_links(file)), part_(file_) {
  const bool direct = written_directly(file);
  refuse_another_kind(file, file_, contents);
  if (!direct) part_ += fmt::format(".{}.part", getpid());
  std::error_code ignored;
  const bool usable = direct ? access(file_.c_str(), W_OK) == 0
                             : !fs::is_directory(file_, ignored) && std::ofstream(part_).good();
  if (!usable) fail("{}: cannot be written; name a file in a folder that exists and is yours", file.string());
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (part_ != file_) fs::remove(part_, ignored);
}

void AtomicFile::commit() {
  std::error_code failed;
  if (part_ != file_) fs::rename(part_, file_, failed);
  if (failed) fail_at_run_time("{}: could not be written ({})", file_.string(), failed.message());
}

void require_distinct(const std::vector<NamedFile>& files) {
  for (auto a = files.begin(); a != files.end(); ++a) {
    for (auto b = files.begin(); b != a; ++b) {
      if (!a->file || !b->file || written_directly(*a->file)) continue;
      if (without_links(*a->file) == without_links(*b->file))
        fail("{} and {} name the same file {}; give each its own", b->option, a->option, a->file->string());
    }
  }
}

void check_writable(const fs::path& file, Contents contents) {
  const AtomicFile probe(file, contents);
}

namespace {

void write_atomically(const fs::path& file, const std::string& text, Contents contents) {
  AtomicFile writer(file, contents);
  std::ofstream out(writer.path(), std::ios::binary);
  out << text << std::flush;
  if (!out) fail_at_run_time("{}: could not be written; is the disk full?", file.string());
  writer.commit();
}

}  // namespace

void write_csv(const fs::path& file, const std::string& text) {
  write_atomically(file, text, Contents::kTable);
}

void write_json(const fs::path& file, Json json) {
  add_former_keys(json);
  write_atomically(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", Contents::kReport);
}

namespace {

/// Text as a cell, in quotes where it holds what would end one (RFC 4180).
std::string cell_of(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string csv_of(const Json& rows) {
  std::vector<std::string> lines(1);
  for (const auto& [key, value] : rows.front().items())
    lines[0] += fmt::format("{}{}", lines[0].empty() ? "" : ",", key);
  for (const Json& row : rows) {
    std::string line;
    for (const auto& [key, value] : row.items()) {
      const std::string cell = value.is_string() ? cell_of(value.get<std::string>()) : value.dump();
      line += fmt::format("{}{}", line.empty() ? "" : ",", cell);
    }
    lines.push_back(line);
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

}  // namespace palpate
