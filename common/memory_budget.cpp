#include "common/memory_budget.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sys/resource.h>
#include <unistd.h>

#include "common/error.h"

namespace palpate {
namespace {

/// The number that a file is; nothing for "max" or where there is no such file.
std::optional<double> number_in(const std::filesystem::path& file) {
  std::ifstream in(file);
  double value = 0;
  if (in >> value) return value;
  return {};
}

/// The number behind `key` in lines "KEY NUMBER".
std::optional<double> number_after(const std::filesystem::path& file, std::string_view key) {
  std::ifstream in(file);
  std::string word, rest;
  double value = 0;
  while (in >> word) {
    if (word == key) {
      if (in >> value) return value;
      return {};
    }
    std::getline(in, rest);
  }
  return {};
}

/// Returns what the limit of one control group leaves.
double remaining_in_group(const std::filesystem::path& folder) {
  const auto most = number_in(folder / "memory.max"), now = number_in(folder / "memory.current");
  if (!most || !now) return std::numeric_limits<double>::infinity();
  return std::max(0.0, *most - *now + number_after(folder / "memory.stat", "inactive_file").value_or(0));
}

/// "/a/b" of the line "0::/a/b".
std::string own_group(const std::filesystem::path& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("0::/")) return line.substr(3);
  }
  return "/";
}

/// Returns what `ulimit -v` leaves of addresses, with room for what libraries take as they are first used.
double remaining_of_addresses(const std::filesystem::path& root) {
  constexpr double kLibraries = 3e8;  // bytes
  rlimit limit{};
  const auto pages = number_in(root / "proc/self/statm");
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || !pages)
    return std::numeric_limits<double>::infinity();
  const double taken = *pages * static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - taken - kLibraries);
}

}  // namespace

double resident_memory() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0, of_files = 0;
  file >> all >> resident >> of_files;
  return (resident - of_files) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double free_memory(const std::filesystem::path& root) {
  const auto kilobytes = number_after(root / "proc/meminfo", "MemAvailable:");
  double free = kilobytes ? 1024 * *kilobytes : std::numeric_limits<double>::infinity();
  free = std::min(free, remaining_of_addresses(root));
  const std::filesystem::path groups = root / "sys/fs/cgroup";
  // Each group is within the limits of those above it.
  for (std::filesystem::path group = own_group(root / "proc/self/cgroup").substr(1);;
       group = group.parent_path()) {
    free = std::min(free, remaining_in_group(groups / group));
    if (group.empty()) return free;
  }
}

std::string bytes_text(double bytes) {
  if (bytes >= 1e9) return fmt::format("{:.1f} GB", bytes / 1e9);
  return bytes >= 1e7 ? fmt::format("{:.0f} MB", bytes / 1e6) : fmt::format("{:.3g} MB", bytes / 1e6);
}

void require_memory(double bytes, double free, std::string_view where, std::string_view what,
                    std::string_view remedy) {
  if (bytes <= free) return;
  const char* const limit = remaining_of_addresses("/") <= free ? " below the limit of `ulimit -v`" : "";
  fail("{}: {} would take {}, and {} are free{}; {}", where, what, bytes_text(bytes), bytes_text(free), limit,
       remedy);
}

}  // namespace palpate
