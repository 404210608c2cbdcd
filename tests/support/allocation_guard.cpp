#include "tests/support/allocation_guard.h"

#include <cstdlib>
#include <malloc.h>
#include <new>

// Replaces the allocator behind `new`, and, where no sanitizer owns it, `malloc` itself (Eigen calls that
// directly).
namespace {
thread_local std::size_t g_count = 0;
thread_local bool g_counting = false;
thread_local std::size_t g_remaining = 0;  // allocations until one fails; 0: none does
void count_one() {
  if (g_counting) ++g_count;
}
/// Whether this one fails.
[[maybe_unused]] bool fails() {
  return g_remaining > 0 && --g_remaining == 0;
}
}  // namespace

#if defined(PALPATE_SANITIZED)
// The sanitizers own the allocator; they call this for every allocation.
extern "C" void __sanitizer_malloc_hook(const volatile void*, std::size_t) {
  count_one();
}
#else
// What a step frees is kept for the next one, not given back to the kernel page by page: tests in which
// bodies are factored take a third less time.
namespace {
[[maybe_unused]] const bool g_keeps =
    mallopt(M_TRIM_THRESHOLD, 1 << 30) == 1 && mallopt(M_MMAP_THRESHOLD, 1 << 25) == 1;
}
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) {
  count_one();
  return fails() ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  count_one();
  return fails() ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  count_one();
  return fails() ? nullptr : __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count_one();
  return fails() ? nullptr : __libc_memalign(alignment, size);
}
}
#endif

namespace palpate::test {

AllocationGuard::AllocationGuard() {
  g_count = 0;
  g_counting = true;
}
AllocationGuard::~AllocationGuard() {
  g_counting = false;
}
std::size_t AllocationGuard::count() const {
  return g_count;
}

AllocationFailure::AllocationFailure(std::size_t n) {
  g_remaining = n;
}
AllocationFailure::~AllocationFailure() {
  g_remaining = 0;
}
bool AllocationFailure::happened() const {
  return g_remaining == 0;
}

}  // namespace palpate::test
