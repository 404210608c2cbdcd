#include "sim_server/setup_cache/cache_entry.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/error.h"

namespace palpate::sim {
namespace {

constexpr std::size_t kPage = 4096;  // of the header: the matrix begins where a page does
constexpr std::array<char, 16> kMagic{"palpate set-up\n"};
constexpr std::uint64_t kVersion = 2;                           // of the layout of a file
constexpr std::uint64_t kMostNumbers = std::uint64_t{1} << 48;  // of a matrix: its bytes can be counted
constexpr std::string_view kEnding = ".setup", kPartEnding = ".part";
constexpr std::size_t kRandom = std::string_view(".XXXXXX").size();

/// KEY.setup.XXXXXX.part
bool is_part_name(std::string_view name) {
  return name.ends_with(kPartEnding) && name.size() > kRandom + kPartEnding.size() &&
         is_entry_name(name.substr(0, name.size() - kRandom - kPartEnding.size()));
}

/// The header as it lies in the file, native byte order: the processor is part of the key.
struct Header {
  std::array<char, 16> magic;
  std::uint64_t version;
  Digest key;
  std::uint64_t rows, cols;
  double seconds;
  std::array<char, 208> what;  // ends in zeros
  Digest checksum;             // of all before, and of the matrix
};
static_assert(sizeof(Header) <= kPage && std::is_trivially_copyable_v<Header>);

Digest checksum_of(const Header& header, const double* matrix) {
  Fingerprint all(Fingerprint::For::kAnyBuild);
  all.add(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, checksum)));
  all.add(std::span(matrix, header.rows * header.cols));
  return all.digest();
}

std::size_t file_bytes(const Header& header) {
  return kPage + static_cast<std::size_t>(header.rows * header.cols) * sizeof(double);
}

/// Closes itself.
struct File {
  int handle;
  explicit File(int opened) : handle(opened) {}
  ~File() {
    if (handle >= 0) ::close(handle);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
};

void write_all(const File& file, const void* data, std::size_t bytes, const std::filesystem::path& name) {
  const char* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t written = ::write(file.handle, from, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("{}: cannot be written: {}", name.string(), std::strerror(errno));
    from += written;
    bytes -= static_cast<std::size_t>(written);
  }
}

void write_atomically(const File& file, const std::filesystem::path& name, const Header& header,
                      const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  if (file.handle < 0) fail("{}: cannot be made: {}", name.string(), std::strerror(errno));
  std::array<char, kPage> page{};
  std::memcpy(page.data(), &header, sizeof(header));
  write_all(file, page.data(), page.size(), name);
  write_all(file, matrix.data(), file_bytes(header) - kPage, name);
  if (::fsync(file.handle) != 0) fail("{}: cannot be written: {}", name.string(), std::strerror(errno));
}

/// The header of a file, if magic, version and sizes are those of an entry.
std::optional<Header> header_of(const File& file) {
  Header header{};
  struct stat status {};
  if (::fstat(file.handle, &status) != 0 || ::read(file.handle, &header, sizeof(header)) != sizeof(header) ||
      header.magic != kMagic || header.version != kVersion || header.what.back() != '\0' ||
      header.rows > kMostNumbers || header.cols > kMostNumbers / std::max<std::uint64_t>(header.rows, 1) ||
      static_cast<std::size_t>(status.st_size) != file_bytes(header))
    return {};
  return header;
}

EntryHeader contents(const Header& header) {
  return {header.key, header.rows, header.cols, header.seconds, header.what.data()};
}

}  // namespace

void MappedMatrix::Unmap::operator()(void* begin) const noexcept {
  ::munmap(begin, bytes);
}

Eigen::Map<Eigen::MatrixXd> MappedMatrix::matrix() const {
  void* const first = static_cast<char*>(start_.get()) + kPage;
  return {static_cast<double*>(first), static_cast<Eigen::Index>(header_.rows),
          static_cast<Eigen::Index>(header_.cols)};
}

std::string note_of_saved(const MappedMatrix& stored, std::string_view source) {
  return fmt::format("from {}, which saved {:.1f} s", source, stored.header().seconds);
}

std::filesystem::path entry_file(const std::filesystem::path& folder, const Digest& key) {
  return folder / (to_text(key) + std::string(kEnding));
}

void write_entry(const std::filesystem::path& folder, const EntryHeader& header,
                 const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  remove_parts(folder, std::chrono::hours(1));
  const std::filesystem::path file = entry_file(folder, header.key);
  if (matrix.outerStride() != matrix.rows()) fail("{}: the matrix is not in one piece", file.string());
  Header raw{};
  raw.magic = kMagic;
  raw.version = kVersion;
  raw.key = header.key;
  raw.rows = static_cast<std::uint64_t>(matrix.rows());
  raw.cols = static_cast<std::uint64_t>(matrix.cols());
  raw.seconds = header.seconds;
  std::copy_n(header.what.begin(), std::min(header.what.size(), raw.what.size() - 1), raw.what.begin());
  raw.checksum = checksum_of(raw, matrix.data());
  std::string part = fmt::format("{}.XXXXXX{}", file.string(), kPartEnding);
  const File written(::mkostemps(part.data(), static_cast<int>(kPartEnding.size()), O_CLOEXEC));
  try {
    write_atomically(written, part, raw, matrix);
    if (::fchmod(written.handle, 0644) != 0) fail("{}: cannot be written: {}", part, std::strerror(errno));
    std::filesystem::rename(part, file);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw;
  }
}

bool is_entry_name(std::string_view name) {
  constexpr std::size_t kDigits = 32;  // of a key
  return name.size() == kDigits + kEnding.size() && name.ends_with(kEnding) &&
         name.substr(0, kDigits).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

int remove_parts(const std::filesystem::path& folder, std::chrono::seconds older) {
  using std::filesystem::file_time_type;
  std::error_code failed;
  int removed = 0;
  for (std::filesystem::directory_iterator at(folder, failed), end; !failed && at != end;
       at.increment(failed)) {
    if (!is_part_name(at->path().filename().native())) continue;
    std::error_code unknown;  // another one may remove it, too
    const file_time_type written = at->last_write_time(unknown);
    if (!unknown && written <= file_time_type::clock::now() - older)
      removed += std::filesystem::remove(at->path(), unknown) ? 1 : 0;
  }
  return removed;
}

MappedMatrix map_entry(const std::filesystem::path& name, const Digest& key) {
  const File file(::open(name.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.handle < 0) fail_at_run_time("{}: cannot be read: {}", name.string(), std::strerror(errno));
  const std::optional<Header> header = header_of(file);
  if (!header) fail("{}: is no entry of this version, or cut off", name.string());
  if (header->key != key) fail("{}: is the entry of another scene under this name", name.string());
  const std::size_t bytes = file_bytes(*header);
  void* const begin =
      ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_POPULATE, file.handle, 0);
  if (begin == MAP_FAILED) fail_at_run_time("{}: cannot be mapped: {}", name.string(), std::strerror(errno));
  MappedMatrix mapped(begin, bytes, contents(*header));
  if (checksum_of(*header, mapped.matrix().data()) != header->checksum)
    fail("{}: is spoilt: its checksum is another", name.string());
  return mapped;
}

std::optional<EntryHeader> read_header(const std::filesystem::path& name) {
  const File file(::open(name.c_str(), O_RDONLY | O_CLOEXEC));
  const std::optional<Header> header = header_of(file);
  return header ? std::optional(contents(*header)) : std::nullopt;
}

}  // namespace palpate::sim
