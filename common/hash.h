#pragma once
#include <cstddef>
#include <cstdint>

#include "common/types.h"

namespace palpate {

/// FNV-1a with 64 bits (Fowler, Noll, Vo) of the bytes in memory: equal runs on one machine have equal
/// hashes. One byte about a nanosecond; no shield against somebody who wants two to be equal.
class Fnv1a {
 public:
  void add(const void* data, std::size_t size) noexcept {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 1099511628211u;
  }
  void add(const Vec3& v) noexcept { add(v.data(), sizeof(Vec3)); }
  std::uint64_t value() const noexcept { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037u;
};

}  // namespace palpate
