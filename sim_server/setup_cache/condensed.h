#pragma once
#include "sim_server/setup_cache/setup_cache.h"
#include "sim_server/sparse/factored_matrix.h"

namespace palpate::sim {

/// Matrices that `sim_server condense` computes of a scene, in a folder. They take most of the set-up time of
/// a large body. They are stored as files of the set-up cache, but under keys that any build on any processor
/// finds again (`Fingerprint::For::kAnyBuild`). Set-up only; one thread.
class Condensed {
 public:
  /// Opens a folder for reading; makes nothing. Throws `Error` where there is no such folder.
  explicit Condensed(std::filesystem::path folder);
  /// Opens a folder, to make what is not in it, with factors by `make_factor`. Throws `Error` where nothing
  /// can be stored there.
  Condensed(std::filesystem::path folder, MakeFactor make_factor);

  /// Empty where the folder is only read.
  const MakeFactor& make_factor() const { return make_factor_; }

  /// The matrix kept under a key. Throws `Error`, with the file, where it is not sound; and where it is not
  /// there and none is made, with `what` it would be ("modes of vibration") of which `scene`.
  std::optional<MappedMatrix> find(const Digest& key, const std::string& what,
                                   const std::string& scene) const;
  /// Keeps a matrix: whole or not at all. Throws `Error` where that is not possible.
  void keep(const Digest& key, double seconds, const Eigen::Ref<const Eigen::MatrixXd>& matrix) const {
    write_entry(folder_, key, seconds, matrix);
  }

 private:
  std::filesystem::path folder_;
  MakeFactor make_factor_;
};

}  // namespace palpate::sim
