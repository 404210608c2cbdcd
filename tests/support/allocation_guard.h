#pragma once
#include <cstddef>

namespace palpate::test {

/// Counts allocations of this thread (malloc and everything built on it) while it lives.
class AllocationGuard {
 public:
  AllocationGuard();
  ~AllocationGuard();
  std::size_t count() const;
};

/// The n-th allocation of this thread while it lives, from 1, finds no memory; no effect under a sanitizer,
/// which owns the allocator.
class AllocationFailure {
 public:
  explicit AllocationFailure(std::size_t n);
  ~AllocationFailure();
  bool happened() const;
};

}  // namespace palpate::test
