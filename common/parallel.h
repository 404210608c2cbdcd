#pragma once
#include <algorithm>
#include <cstddef>

#ifdef PALPATE_WITH_TBB
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace palpate {

/// Calls `work(begin, end)` for blocks of `block` of the numbers 0 to n, on all cores (oneTBB), or one after
/// the other where it is not built in. What one call writes no other may touch: so the result is the same
/// whatever the number of threads, bit by bit. While it waits, a thread takes up no work of a loop around
/// this one: what that holds is there once a core, however loops are nested.
template <class Work>
void parallel_blocks(std::size_t n, std::size_t block, const Work& work) {
#ifdef PALPATE_WITH_TBB
  using Block = oneapi::tbb::blocked_range<std::size_t>;
  const std::size_t blocks = (n + block - 1) / block;
  oneapi::tbb::this_task_arena::isolate([&] {
    oneapi::tbb::parallel_for(Block(0, blocks, 1), [&](const Block& range) {
      for (std::size_t b = range.begin(); b != range.end(); ++b)
        work(b * block, std::min(n, (b + 1) * block));
    });
  });
#else
  for (std::size_t begin = 0; begin < n; begin += block) work(begin, std::min(n, begin + block));
#endif
}

/// Returns how many threads such a loop uses at most.
inline std::size_t threads() {
#ifdef PALPATE_WITH_TBB
  using Control = oneapi::tbb::global_control;
  return Control::active_value(Control::max_allowed_parallelism);
#else
  return 1;
#endif
}

/// Calls `work` so that what it asks of `parallel_blocks` is done in this thread alone: for work that must
/// take no core from who is in a hurry.
template <class Work>
void in_one_thread(const Work& work) {
#ifdef PALPATE_WITH_TBB
  oneapi::tbb::task_arena(1).execute(work);
#else
  work();
#endif
}

}  // namespace palpate
