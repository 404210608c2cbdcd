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
constexpr std::uint64_t kVersion = 1;
constexpr std::uint64_t kMostNumbers = std::uint64_t{1} << 48;  // of a matrix: its bytes can be counted
constexpr std::string_view kPartEnding = ".part";
constexpr std::size_t kRandom = 7;  // of ".XXXXXX"

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
  Digest matrix;               // checksum
  Digest header;               // of all before
};
static_assert(sizeof(Header) <= kPage && std::is_trivially_copyable_v<Header>);

Digest checksum_of(const Header& header) {
  return digest_of(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, header)));
}

std::size_t matrix_bytes(std::uint64_t rows, std::uint64_t cols) {
  return static_cast<std::size_t>(rows * cols) * sizeof(double);
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

void write_whole(const File& file, const std::filesystem::path& name, const Header& header,
                 const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  if (file.handle < 0) fail("{}: cannot be made: {}", name.string(), std::strerror(errno));
  std::array<char, kPage> page{};
  std::memcpy(page.data(), &header, sizeof(header));
  write_all(file, page.data(), page.size(), name);
  write_all(file, matrix.data(), matrix_bytes(header.rows, header.cols), name);
  if (::fsync(file.handle) != 0) fail("{}: cannot be written: {}", name.string(), std::strerror(errno));
}

/// Where its own words are right: magic, version, checksum, and sizes that a matrix can have.
bool is_sound(const Header& header) {
  return header.magic == kMagic && header.version == kVersion && checksum_of(header) == header.header &&
         header.rows <= kMostNumbers &&
         header.cols <= kMostNumbers / std::max<std::uint64_t>(header.rows, 1) && header.what.back() == '\0';
}

EntryHeader told(const Header& header) {
  return {header.key, header.rows, header.cols, header.seconds, header.what.data()};
}

}  // namespace

MappedMatrix::MappedMatrix(void* begin, std::size_t bytes, const EntryHeader& header)
    : begin_(begin), bytes_(bytes), header_(header) {}

MappedMatrix::~MappedMatrix() {
  if (begin_ != nullptr) ::munmap(begin_, bytes_);
}

MappedMatrix::MappedMatrix(MappedMatrix&& other) noexcept
    : begin_(std::exchange(other.begin_, nullptr)), bytes_(other.bytes_), header_(std::move(other.header_)) {}

MappedMatrix& MappedMatrix::operator=(MappedMatrix&& other) noexcept {
  std::swap(begin_, other.begin_);
  std::swap(bytes_, other.bytes_);
  std::swap(header_, other.header_);
  return *this;
}

Eigen::Map<Eigen::MatrixXd> MappedMatrix::matrix() const {
  void* const first = static_cast<char*>(begin_) + kPage;
  return {static_cast<double*>(first), static_cast<Eigen::Index>(header_.rows),
          static_cast<Eigen::Index>(header_.cols)};
}

std::string note_of_saved(const MappedMatrix& kept, std::string_view source) {
  return fmt::format("from {}, which saved {:.1f} s", source, kept.header().seconds);
}

void write_entry(const std::filesystem::path& file, const EntryHeader& header,
                 const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  if (matrix.outerStride() != matrix.rows()) fail("{}: the matrix is not in one piece", file.string());
  Header raw{};
  raw.magic = kMagic;
  raw.version = kVersion;
  raw.key = header.key;
  raw.rows = static_cast<std::uint64_t>(matrix.rows());
  raw.cols = static_cast<std::uint64_t>(matrix.cols());
  raw.seconds = header.seconds;
  std::copy_n(header.what.begin(), std::min(header.what.size(), raw.what.size() - 1), raw.what.begin());
  raw.matrix = digest_of(std::as_bytes(std::span(matrix.data(), static_cast<std::size_t>(matrix.size()))));
  raw.header = checksum_of(raw);
  std::string part = fmt::format("{}.XXXXXX{}", file.string(), kPartEnding);
  const File written(::mkostemps(part.data(), static_cast<int>(kPartEnding.size()), O_CLOEXEC));
  try {
    write_whole(written, part, raw, matrix);
    if (::fchmod(written.handle, 0644) != 0) fail("{}: cannot be written: {}", part, std::strerror(errno));
    std::filesystem::rename(part, file);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw;
  }
}

bool is_entry_name(std::string_view name) {
  constexpr std::string_view kEnding = ".setup";
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
  struct stat status {};
  Header header{};
  if (::fstat(file.handle, &status) != 0 || ::read(file.handle, &header, sizeof(header)) != sizeof(header))
    fail("{}: is cut off", name.string());
  if (!is_sound(header)) fail("{}: its header is spoilt, or of another version", name.string());
  if (header.key != key) fail("{}: is the entry of another scene under this name", name.string());
  const std::size_t bytes = kPage + matrix_bytes(header.rows, header.cols);
  if (static_cast<std::size_t>(status.st_size) != bytes) fail("{}: is cut off", name.string());
  void* const begin =
      ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_POPULATE, file.handle, 0);
  if (begin == MAP_FAILED) fail_at_run_time("{}: cannot be mapped: {}", name.string(), std::strerror(errno));
  MappedMatrix mapped(begin, bytes, told(header));
  const auto matrix = mapped.matrix();
  if (digest_of(std::as_bytes(std::span(matrix.data(), static_cast<std::size_t>(matrix.size())))) !=
      header.matrix)
    fail("{}: its numbers are spoilt", name.string());
  return mapped;
}

std::optional<EntryHeader> read_header(const std::filesystem::path& name) {
  const File file(::open(name.c_str(), O_RDONLY | O_CLOEXEC));
  Header header{};
  if (file.handle < 0 || ::read(file.handle, &header, sizeof(header)) != sizeof(header) || !is_sound(header))
    return {};
  return told(header);
}

}  // namespace palpate::sim
