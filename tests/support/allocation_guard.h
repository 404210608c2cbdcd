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

}  // namespace palpate::test
