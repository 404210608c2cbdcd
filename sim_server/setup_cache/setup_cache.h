#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "sim_server/setup_cache/fingerprint.h"

namespace palpate::sim {

/// A matrix in a file, mapped copy-on-write: what is written to it stays in this process. Movable.
class MappedMatrix {
 public:
  MappedMatrix(void* begin, std::size_t bytes) : start_(begin, Unmap{bytes}) {}

  Eigen::Map<Eigen::MatrixXd> matrix() const;
  /// "from the set-up cache, which saved 3.2 s"; `source`: where it came from.
  std::string note_of_saved(std::string_view source) const;

 private:
  struct Unmap {
    std::size_t bytes;
    void operator()(void* begin) const noexcept;
  };

  std::unique_ptr<void, Unmap> start_;
};

/// File of an entry: FOLDER/KEY.setup.
std::filesystem::path entry_file(const std::filesystem::path& folder, const Digest& key);

/// Writes an entry under a name that no other writer has, then renames it: whole or not at all. `seconds`:
/// that computing the matrix took. Throws `Error`.
void write_entry(const std::filesystem::path& folder, const Digest& key, double seconds,
                 const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// Maps the entry with this key; nothing where there is no file. Throws `Error` if its version or checksum
/// is another; of kind `kRun` if the file cannot be read. O(bytes).
std::optional<MappedMatrix> map_entry(const std::filesystem::path& file, const Digest& key);

/// Cache of set-up results in a folder. Several programs may use one at once. Set-up only; one thread.
class SetupCache {
 public:
  /// The folder is made when something is kept. `most_bytes`: bound of all entries in it, bytes.
  explicit SetupCache(std::filesystem::path folder, double most_bytes = 4e9)
      : folder_(std::move(folder)), most_bytes_(most_bytes) {}

  /// The matrix kept under a key; nothing where there is none. One that is not sound is reported and removed.
  std::optional<MappedMatrix> find(const Digest& key) const;
  /// Keeps a matrix that took `seconds` to compute, unless it passes the bound alone. Removes all other
  /// entries where they would pass it together. The first matrix that cannot be kept costs a warning.
  void keep(const Digest& key, double seconds, const Eigen::Ref<const Eigen::MatrixXd>& matrix) const;

 private:
  void make_room(double bytes) const;

  std::filesystem::path folder_;
  double most_bytes_;
  mutable bool has_warned_ = false;
};

}  // namespace palpate::sim
