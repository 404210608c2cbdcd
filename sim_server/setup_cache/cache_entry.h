#pragma once
#include <Eigen/Core>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

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
  MappedMatrix(void* begin, std::size_t bytes, EntryHeader header)
      : start_(begin, Unmap{bytes}), header_(std::move(header)) {}

  Eigen::Map<Eigen::MatrixXd> matrix() const;
  const EntryHeader& header() const { return header_; }

 private:
  struct Unmap {
    std::size_t bytes;
    void operator()(void* begin) const noexcept;
  };

  std::unique_ptr<void, Unmap> start_;
  EntryHeader header_;
};

/// "from the set-up cache, which saved 3.2 s"; `source`: where it came from.
std::string note_of_saved(const MappedMatrix& stored, std::string_view source = "the set-up cache");

/// File of an entry: FOLDER/KEY.setup.
std::filesystem::path entry_file(const std::filesystem::path& folder, const Digest& key);

/// Writes an entry under another name, which no other writer has, syncs and renames it: whole or not at all.
/// Removes what writers that were interrupted an hour ago left in the folder. Throws `Error`.
void write_entry(const std::filesystem::path& folder, const EntryHeader& header,
                 const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// True if a file is called KEY.setup (32 digits), as no other program calls its own: the folder may belong
/// to anybody.
bool is_entry_name(std::string_view name);

/// Removes what writers that were interrupted left in a folder, if it has not changed for so long; how many
/// files that were.
int remove_parts(const std::filesystem::path& folder, std::chrono::seconds older);

/// Maps the entry with this key. Throws `Error` with what is wrong with it, of kind `kRun` where that is not
/// the file itself, but that it cannot be opened or mapped: nothing of it is trusted before its size and its
/// checksum agree. O(bytes).
MappedMatrix map_entry(const std::filesystem::path& file, const Digest& key);

/// The header alone, without its checksum; nothing where it is of another kind, version or size of file.
std::optional<EntryHeader> read_header(const std::filesystem::path& file);

}  // namespace palpate::sim
