#include "sim_server/setup_cache/setup_cache.h"

#include <algorithm>
#include <cstdlib>

#include "common/error.h"
#include "common/log.h"
#include "common/memory_budget.h"

namespace palpate::sim {
namespace {

namespace fs = std::filesystem;

/// The entries of a folder; none where it cannot be read.
std::vector<fs::path> entries_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    if (is_entry_name(at->path().filename().native()) && at->is_regular_file(failed))
      files.push_back(at->path());
  }
  return files;
}

}  // namespace

SetupCache::SetupCache(fs::path folder, double most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes) {}

std::optional<fs::path> SetupCache::usual_folder() {
  const char *const cache = std::getenv("XDG_CACHE_HOME"), *const home = std::getenv("HOME");
  if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "palpate";
  if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "palpate";
  return {};
}

std::optional<MappedMatrix> SetupCache::find(const Digest& key) const {
  const fs::path file = entry_file(folder_, key);
  std::error_code failed;
  if (!fs::exists(file, failed)) return {};
  try {
    MappedMatrix found = map_entry(file, key);
    fs::last_write_time(file, fs::file_time_type::clock::now(), failed);  // it is in use
    return found;
  } catch (const Error& error) {
    const bool spoilt = error.exit_code() == static_cast<int>(Error::Kind::kInput);
    log::warning("set-up cache: {}; it is {}made again", error.what(), spoilt ? "removed and " : "");
    if (spoilt) fs::remove(file, failed);
    return {};
  }
}

void SetupCache::keep(const EntryHeader& header, const Eigen::Ref<const Eigen::MatrixXd>& matrix) const {
  try {
    if (static_cast<double>(matrix.size()) * sizeof(double) > most_bytes_) return;
    fs::create_directories(folder_);
    write_entry(folder_, header, matrix);
    make_room(header.key);
  } catch (const std::exception& error) {
    log::warning("set-up cache: nothing kept: {}; --cache names another folder, --no-cache none",
                 error.what());
  }
}

/// The entries not used for longest go until what is left fits; the newest stays.
void SetupCache::make_room(const Digest& newest) const {
  double stored = 0, removed = 0;
  int count = 0;
  for (const Entry& entry : list()) {
    stored += entry.bytes;
    if (stored <= most_bytes_ || entry.file == entry_file(folder_, newest)) continue;
    std::error_code failed;
    if (!fs::remove(entry.file, failed)) continue;
    stored -= entry.bytes;
    removed += entry.bytes;
    ++count;
  }
  if (count > 0)
    log::info("set-up cache: {} of the oldest entries removed, {}: it holds {} at most", count,
              bytes_text(removed), bytes_text(most_bytes_));
}

std::vector<SetupCache::Entry> SetupCache::list() const {
  std::vector<Entry> entries;
  for (const fs::path& file : entries_in(folder_)) {
    std::error_code failed;
    Entry entry{file, static_cast<double>(fs::file_size(file, failed)), fs::last_write_time(file, failed),
                read_header(file)};
    if (!failed) entries.push_back(std::move(entry));
  }
  std::ranges::sort(entries, [](const Entry& a, const Entry& b) {
    return a.used != b.used ? a.used > b.used : a.file < b.file;
  });
  return entries;
}

std::pair<int, double> SetupCache::clear() const {
  std::pair<int, double> removed{remove_parts(folder_, std::chrono::seconds(0)), 0};
  for (const Entry& entry : list()) {
    std::error_code failed;
    if (!fs::remove(entry.file, failed)) continue;
    ++removed.first;
    removed.second += entry.bytes;
  }
  return removed;
}

}  // namespace palpate::sim
