#pragma once
#include <chrono>
#include <vector>

#include "sim_server/setup_cache/cache_entry.h"

namespace palpate::sim {

/// Cache of set-up results in a folder. Several programs may use one at once. Set-up only; one thread.
class SetupCache {
 public:
  /// The folder is made when something is kept. `most_bytes`: beyond, the entries not used for longest go.
  explicit SetupCache(std::filesystem::path folder, double most_bytes = 4e9);
  /// $XDG_CACHE_HOME/palpate, else ~/.cache/palpate; nothing where neither is known.
  static std::optional<std::filesystem::path> usual_folder();

  /// The matrix kept under a key; nothing where there is none. One that is not sound is reported and removed.
  std::optional<MappedMatrix> find(const Digest& key) const;
  /// Keeps a matrix; where that is not possible, a warning says why.
  void keep(const EntryHeader& header, const Eigen::Ref<const Eigen::MatrixXd>& matrix) const;

  struct Entry {
    std::filesystem::path file;
    double bytes = 0;
    std::filesystem::file_time_type used;
    std::optional<EntryHeader> header;  ///< nothing of one that is not sound
  };
  /// The one used last comes first.
  std::vector<Entry> list() const;
  /// Removes all entries, and what an interrupted writer left behind; tells how many and how much, bytes.
  std::pair<int, double> clear() const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  void make_room(const Digest& newest) const;

  std::filesystem::path folder_;
  double most_bytes_;
};

}  // namespace palpate::sim
