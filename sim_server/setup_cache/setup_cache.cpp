#include "sim_server/setup_cache/setup_cache.h"

#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/core.h>
#include <fstream>
#include <random>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include "common/error.h"
#include "common/log.h"
#include "common/memory_budget.h"

namespace palpate::sim {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kPage = 4096;  // of the header: the matrix begins where a page does
constexpr std::string_view kEnding = ".setup";

/// The header as it lies in the file, native byte order: the processor is part of the key. The size of the
/// file tells the number of columns.
struct Header {
  std::array<char, 16> magic{"palpate setup 3"};  // with the version of the layout
  std::uint64_t rows = 0;
  double seconds = 0;
  Digest checksum{};  // of the key, of all before, and of the matrix
};
static_assert(sizeof(Header) <= kPage && std::is_trivially_copyable_v<Header>);

Digest checksum_of(const Header& header, const Digest& key, const double* matrix, std::size_t numbers) {
  Fingerprint all(Fingerprint::For::kAnyBuild);
  all.add(std::span<const std::uint64_t>(key));
  all.add(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, checksum)));
  all.add(std::span(matrix, numbers));
  return all.digest();
}

const Header& header_at(const void* begin) {
  return *static_cast<const Header*>(begin);
}

/// True of KEY.setup, and of the longer name that it has while it is written: the folder may belong to
/// anybody.
bool is_entry_name(std::string_view name) {
  constexpr std::size_t kDigits = 32;  // of a key
  return name.find_first_not_of("0123456789abcdef") == kDigits && name.substr(kDigits).starts_with(kEnding);
}

}  // namespace

void MappedMatrix::Unmap::operator()(void* begin) const noexcept {
  ::munmap(begin, bytes);
}

Eigen::Map<Eigen::MatrixXd> MappedMatrix::matrix() const {
  const std::size_t numbers = (start_.get_deleter().bytes - kPage) / sizeof(double);
  const auto rows = static_cast<Eigen::Index>(header_at(start_.get()).rows);
  void* const first = static_cast<char*>(start_.get()) + kPage;
  return {static_cast<double*>(first), rows, static_cast<Eigen::Index>(numbers) / rows};
}

std::string MappedMatrix::note_of_saved(std::string_view source) const {
  return fmt::format("from {}, which saved {:.1f} s", source, header_at(start_.get()).seconds);
}

fs::path entry_file(const fs::path& folder, const Digest& key) {
  return folder / (to_text(key) + std::string(kEnding));
}

void write_entry(const fs::path& folder, const Digest& key, double seconds,
                 const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  assert(matrix.outerStride() == matrix.rows());
  const auto numbers = static_cast<std::size_t>(matrix.size());
  Header header{.rows = static_cast<std::uint64_t>(matrix.rows()), .seconds = seconds};
  header.checksum = checksum_of(header, key, matrix.data(), numbers);
  const fs::path file = entry_file(folder, key),
                 part = fmt::format("{}.{:08x}", file.string(), std::random_device()());
  errno = 0;
  std::ofstream out(part, std::ios::binary);
  out.write(reinterpret_cast<const char*>(&header), sizeof(header));
  out.seekp(kPage);
  out.write(reinterpret_cast<const char*>(matrix.data()),
            static_cast<std::streamsize>(numbers * sizeof(double)));
  out.close();
  std::error_code failed, ignored;
  if (!out) failed = {errno != 0 ? errno : EIO, std::generic_category()};
  if (!failed) fs::rename(part, file, failed);
  if (!failed) return;
  fs::remove(part, ignored);
  fail("{}: cannot be written: {}", file.string(), failed.message());
}

std::optional<MappedMatrix> map_entry(const fs::path& name, const Digest& key) {
  std::error_code failed;
  const std::size_t bytes = fs::file_size(name, failed);
  if (failed == std::errc::no_such_file_or_directory || failed == std::errc::not_a_directory) return {};
  if (!failed && bytes < kPage) fail("{}: is cut off", name.string());
  const int file = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
  void* const begin =
      file < 0 ? MAP_FAILED
               : ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_POPULATE, file, 0);
  if (begin == MAP_FAILED) failed = {errno, std::generic_category()};
  if (file >= 0) ::close(file);
  if (failed) fail_at_run_time("{}: cannot be read: {}", name.string(), failed.message());
  MappedMatrix mapped(begin, bytes);
  const Header& header = header_at(begin);
  if (header.magic != Header().magic) fail("{}: is no entry of this version", name.string());
  const std::size_t numbers = (bytes - kPage) / sizeof(double);
  if (header.rows == 0 || header.rows > numbers || numbers % header.rows != 0 ||
      bytes % sizeof(double) != 0 ||
      checksum_of(header, key, mapped.matrix().data(), numbers) != header.checksum)
    fail("{}: is spoilt, cut off or the entry of another scene", name.string());
  return mapped;
}

std::optional<MappedMatrix> SetupCache::find(const Digest& key) const {
  const fs::path file = entry_file(folder_, key);
  try {
    return map_entry(file, key);
  } catch (const Error& error) {
    // One that only cannot be read now, as for want of memory or rights, may be sound.
    const bool is_spoilt = error.exit_code() == static_cast<int>(Error::Kind::kInput);
    log::warning("set-up cache: {}; it is {}made again", error.what(), is_spoilt ? "removed and " : "");
    std::error_code ignored;
    if (is_spoilt) fs::remove(file, ignored);
    return {};
  }
}

void SetupCache::keep(const Digest& key, double seconds,
                      const Eigen::Ref<const Eigen::MatrixXd>& matrix) const {
  const double bytes = static_cast<double>(kPage + static_cast<std::size_t>(matrix.size()) * sizeof(double));
  if (matrix.size() == 0 || bytes > most_bytes_) return;
  try {
    fs::create_directories(folder_);
    make_room(bytes);
    write_entry(folder_, key, seconds, matrix);
  } catch (const std::exception& error) {
    if (!has_warned_)
      log::warning("set-up cache: nothing kept: {}; --cache names another folder, --no-cache none",
                   error.what());
    has_warned_ = true;
  }
}

/// Removes all entries, and what interrupted writers left, if `bytes` more are too many.
void SetupCache::make_room(double bytes) const {
  std::vector<fs::path> files;
  double stored = 0;
  std::error_code gone;  // another program removes or renames a file at the same time
  for (const fs::directory_entry& file : fs::directory_iterator(folder_)) {
    if (!is_entry_name(file.path().filename().native())) continue;
    const auto size = static_cast<double>(file.file_size(gone));
    if (gone) continue;
    stored += size;
    files.push_back(file.path());
  }
  if (stored + bytes <= most_bytes_) return;
  for (const fs::path& file : files) fs::remove(file, gone);
  log::info("set-up cache: removed all {} in {}, which {} more would bring past {}", bytes_text(stored),
            folder_.string(), bytes_text(bytes), bytes_text(most_bytes_));
}

}  // namespace palpate::sim
