#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace palpate::sim {

/// 128 bits of XXH3 (Collet): of keys, of file names and of checksums.
using Digest = std::array<std::uint64_t, 2>;

/// 32 hexadecimal digits.
std::string to_text(const Digest& digest);

/// Hash of several spans of values, one after another: of all that a result follows from, or of a file.
class Fingerprint {
 public:
  /// Scope in which results are valid. The key for `kThisBuild` starts with the program's own bytes and the
  /// processor's name and features: another build, or another processor, rounds otherwise.
  enum class For { kThisBuild, kAnyBuild };
  explicit Fingerprint(For whom = For::kThisBuild);
  ~Fingerprint();

  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(std::as_bytes(values));
  }
  Digest digest() const;

 private:
  void add_bytes(std::span<const std::byte> bytes);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate::sim
