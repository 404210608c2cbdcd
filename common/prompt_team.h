#pragma once
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace palpate {

/// A few threads that share the parts of some work which comes again and again, some tens of microseconds
/// apart: about as long as it takes to wake a thread that sleeps. So they stay awake for 0.2 ms after each,
/// and sleep from then on. One thread asks for work. Helpers have ordinary priority, also where that thread
/// has real-time priority: it sleeps, too, where a part takes 0.2 ms longer than its own.
class PromptTeam {
 public:
  /// Sets the number of threads beside the caller's (>= 0), which start with the first work of more than one
  /// part.
  explicit PromptTeam(int helpers) : most_helpers_(helpers) {}
  /// Ends them.
  ~PromptTeam();
  PromptTeam(const PromptTeam&) = delete;
  PromptTeam& operator=(const PromptTeam&) = delete;

  /// Calls `work(part)` once for each part from 0 to `parts` (at most `kMostParts`), and returns when all
  /// that is done. This thread begins with the first part, helpers with the last, so that each finds in its
  /// cache what it left there; where none is awake, this one does all. What one part writes no other may
  /// touch, and `work` does not throw: then the result is the same whoever did what. Starts the threads, the
  /// first time, or goes on without those that cannot be had; otherwise neither allocates nor locks.
  template <class Work>
  void run(std::uint32_t parts, const Work& work) noexcept {
    begin(parts, work);
    finish();
  }
  /// Starts the work of `run` and returns, so that this thread can do something else. Helpers take parts, and
  /// `finish` does the parts that they have not started, and waits for the rest. `work` must stay until then,
  /// and so must what it reads.
  template <class Work>
  void begin(std::uint32_t parts, const Work& work) noexcept {
    begin({&work, [](const void* what, std::uint32_t part) { (*static_cast<const Work*>(what))(part); }},
          parts);
  }
  void finish() noexcept;
  static constexpr std::uint32_t kMostParts = 0xffff;

 private:
  struct Job {
    const void* work = nullptr;
    void (*call)(const void* work, std::uint32_t part) = nullptr;
  };
  void begin(const Job& job, std::uint32_t parts) noexcept;
  void start_helpers() noexcept;
  void help() noexcept;
  bool do_one(bool from_the_front) noexcept;
  void wait_for_work(std::uint32_t last) noexcept;

  int most_helpers_;
  Job job_;
  std::atomic<std::uint64_t> open_{0};    // number of the job, and its parts from .. to that nobody has begun
  std::atomic<std::uint32_t> number_{0};  // of the job
  std::atomic<std::uint32_t> undone_{0};  // parts of it
  std::atomic<bool> ending_{false};
  std::vector<std::thread> helpers_;
};

}  // namespace palpate
