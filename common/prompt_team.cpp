#include "common/prompt_team.h"

#include "common/clock.h"
#include "common/realtime.h"

namespace palpate {
namespace {

constexpr Time kAwake = std::chrono::microseconds(200);  // before a thread sleeps
constexpr int kPollsPerClock = 64;                       // between two looks at the time

/// The parts of a job that nobody has begun yet, in one word.
struct Open {
  std::uint32_t number, from, to;
  explicit Open(std::uint64_t word)
      : number(static_cast<std::uint32_t>(word >> 32)), from(word >> 16 & 0xffff), to(word & 0xffff) {}
  std::uint64_t word() const { return std::uint64_t{number} << 32 | std::uint64_t{from} << 16 | to; }
};

/// The core does little for some cycles.
void pause() noexcept {
#ifdef __x86_64__
  __builtin_ia32_pause();
#endif
}

/// Looks until it is `condition`, for so long; whether it is.
template <class Condition>
bool poll_until(const Condition& condition, Time longest) noexcept {
  if (condition()) return true;
  const Time end = now() + longest;
  do {
    for (int poll = 0; poll < kPollsPerClock; ++poll) {
      if (condition()) return true;
      pause();
    }
  } while (now() < end);
  return false;
}

}  // namespace

PromptTeam::~PromptTeam() {
  ending_ = true;
  ++number_;
  number_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void PromptTeam::start_helpers() noexcept {
  try {
    while (static_cast<int>(helpers_.size()) < most_helpers_) helpers_.emplace_back([this] { help(); });
  } catch (...) {
    most_helpers_ = static_cast<int>(helpers_.size());  // the others do their parts
  }
}

/// Starts a job. What was written before `open_` is visible to whoever takes a part of it; nothing of it
/// changes before all parts are done.
void PromptTeam::begin(const Job& job, std::uint32_t parts) noexcept {
  job_ = job;
  undone_.store(parts, std::memory_order_relaxed);
  const std::uint32_t number = number_.load(std::memory_order_relaxed) + 1;
  Open open(0);
  open.number = number, open.to = parts;
  open_.store(open.word(), std::memory_order_release);
  if (parts < 2 || most_helpers_ == 0) return;
  number_.store(number);
  if (static_cast<int>(helpers_.size()) < most_helpers_) start_helpers();
  number_.notify_all();
}

void PromptTeam::finish() noexcept {
  while (do_one(true)) {
  }
  const auto undone = [this] { return undone_.load(std::memory_order_acquire); };
  if (poll_until([&] { return undone() == 0; }, kAwake)) return;
  // Whoever has the last part is held up: perhaps by this very thread.
  for (std::uint32_t parts = undone(); parts > 0; parts = undone())
    undone_.wait(parts, std::memory_order_acquire);
}

/// Takes a part that nobody has begun, and does it; false: there is none.
bool PromptTeam::do_one(bool from_the_front) noexcept {
  std::uint64_t before = open_.load(std::memory_order_acquire);
  while (true) {
    Open open(before);
    if (open.from == open.to) return false;
    const std::uint32_t part = from_the_front ? open.from++ : --open.to;
    if (!open_.compare_exchange_weak(before, open.word(), std::memory_order_acq_rel)) continue;
    job_.call(job_.work, part);
    if (undone_.fetch_sub(1) == 1 && !from_the_front) undone_.notify_one();
    return true;
  }
}

/// Waits for a job of another number than the `last`, or for the end.
void PromptTeam::wait_for_work(std::uint32_t last) noexcept {
  const auto came = [&] { return number_.load(std::memory_order_acquire) != last; };
  if (!poll_until(came, kAwake)) number_.wait(last, std::memory_order_acquire);
}

void PromptTeam::help() noexcept {
  take_role(ThreadRole::kHelp);
  for (std::uint32_t last = 0;;) {
    wait_for_work(last);
    last = number_.load(std::memory_order_acquire);
    if (ending_) return;  // said before the last number came
    while (do_one(false)) {
    }
  }
}

}  // namespace palpate
