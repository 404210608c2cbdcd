#include "tests/support/allocation_guard.h"

#include <cstdlib>
#include <new>

// Replaces the allocator behind `new`, and, where no sanitizer owns it, `malloc` itself (Eigen calls that
// directly).
namespace {
thread_local std::size_t g_count = 0;
thread_local bool g_counting = false;
void count_one() {
  if (g_counting) ++g_count;
}
}  // namespace

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// The sanitizers own the allocator; they call this for every allocation.
extern "C" void __sanitizer_malloc_hook(const volatile void*, std::size_t) {
  count_one();
}
#else
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) {
  count_one();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  count_one();
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  count_one();
  return __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count_one();
  return __libc_memalign(alignment, size);
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

}  // namespace palpate::test
