#pragma once
#include <Eigen/Core>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "sim_server/setup_cache/fingerprint.h"

namespace palpate::sim {

/// Header of an entry.
struct EntryHeader {
  Digest key{};
  std::uint64_t rows = 0, cols = 0;
  double seconds = 0;  ///< that computing it took
  std::string what;    ///< for lists, at most 200 bytes: "compliance of ..."
};

/// A matrix in a file, mapped copy-on-write: what is written to it stays in this process. Movable.
class MappedMatrix {
 public:
  MappedMatrix(void* begin, std::size_t bytes, const EntryHeader& header);
  ~MappedMatrix();
  MappedMatrix(MappedMatrix&& other) noexcept;
  MappedMatrix& operator=(MappedMatrix&& other) noexcept;

  Eigen::Map<Eigen::MatrixXd> matrix() const;
  const EntryHeader& header() const { return header_; }

 private:
  void* begin_;
  std::size_t bytes_;
  EntryHeader header_;
};

/// "from the set-up cache, which saved 3.2 s"; `source`: where it came from.
std::string note_of_saved(const MappedMatrix& kept, std::string_view source = "the set-up cache");

/// Writes an entry under another name, which no other writer has, syncs and renames it: whole or not at all.
/// Throws `Error`.
void write_entry(const std::filesystem::path& file, const EntryHeader& header,
                 const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// True if a file is called KEY.setup (32 digits), as no other program calls its own: the folder may belong
/// to anybody.
bool is_entry_name(std::string_view name);

/// Removes what writers that were interrupted left in a folder, if it has not changed for so long; how many
/// files that were.
int remove_parts(const std::filesystem::path& folder, std::chrono::seconds older = std::chrono::hours(1));

/// Maps the entry with this key. Throws `Error` with what is wrong with it, of kind `kRun` where that is not
/// the file itself, but that it cannot be opened or mapped: nothing of it is trusted before its size and both
/// checksums agree. O(bytes).
MappedMatrix map_entry(const std::filesystem::path& file, const Digest& key);

/// The header alone; nothing where there is none that is sound.
std::optional<EntryHeader> read_header(const std::filesystem::path& file);

}  // namespace palpate::sim
