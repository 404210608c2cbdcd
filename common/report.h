#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/histogram.h"

namespace palpate {

using Json = nlohmann::ordered_json;

/// {"p50": .., "p99": .., "p999": .., "max": ..} of a histogram of nanoseconds, divided by `unit_ns`
/// (1e3 for microseconds, 1e6 for milliseconds).
Json quantiles(const Histogram& histogram, double unit_ns);

/// Kind of content of a file that a program writes.
enum class Contents { kReport, kTable, kCapture, kShapes };

/// A file that appears whole, or when it is worth a name, or not at all: what is written goes to `path()`
/// beside it; `commit` gives it its name; going out of scope without that removes it. A link stays a link:
/// what it points to is replaced. What is no regular file (a device, a pipe, /dev/stdout) is written
/// directly.
class AtomicFile {
 public:
  /// Throws `Error` (input) if it cannot be written, or would take the place of a file whose name says that
  /// it is something else, as a mesh. Does not open what is written directly: a pipe is opened once, by
  /// whoever writes.
  explicit AtomicFile(const std::filesystem::path& file, Contents contents);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& path() const { return part_; }
  /// Throws `Error` (run time).
  void commit();

 private:
  std::filesystem::path file_, part_;
};

/// A file that a command line names, or that a scene or client file on it names, and what names it.
struct NamedFile {
  std::string option;  ///< "--out", or "FILE:LINE" of a key
  std::optional<std::filesystem::path> file;
};

/// Throws `Error` (input) when two of them are the same regular file: one would overwrite the other.
void require_distinct(const std::vector<NamedFile>& files);

/// Throws `Error` now, rather than after the run, if `file` could not be written.
void check_writable(const std::filesystem::path& file, Contents contents);

/// Writes a table of `csv_of`, whole or not at all. Throws `Error`.
void write_csv(const std::filesystem::path& file, const std::string& text);

/// Writes a JSON document, indented, atomically, with the former names of its keys (`add_former_keys`).
/// Throws `Error`.
void write_json(const std::filesystem::path& file, Json json);

/// An array of flat objects with the same keys as CSV: a line of keys, then a line an object.
std::string csv_of(const Json& rows);

}  // namespace palpate
