#pragma once
#include <chrono>
#include <future>
#include <memory>
#include <utility>

#include "common/parallel.h"
#include "common/realtime.h"

namespace palpate {

/// Work that a background thread does once, on one core, while steps continue. Copies of a job refer to the
/// same work and to the same result, so that a saved state can hold one. The last copy to go waits for the
/// work to end. Owned by one thread at a time.
template <class Result>
class BackgroundJob {
 public:
  /// Starts `make()`, which returns a `Result`, in a thread of this name (at most 15 characters). The job
  /// before must have been taken.
  template <class Make>
  void start(const char* name, Make make) {
    work_ = std::async(std::launch::async, [name, make = std::move(make)]() mutable {
              take_role(ThreadRole::kPage, name);
              std::shared_ptr<Result> result;
              in_one_thread([&] { result = std::make_shared<Result>(make()); });
              return result;
            }).share();
  }
  /// True from `start` to `take`.
  bool has_started() const { return work_.valid(); }
  /// True once the work of a job that has started has ended.
  bool is_ready() const {
    return has_started() && work_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
  /// Waits for the work, if any has started.
  void wait() const {
    if (has_started()) work_.wait();
  }
  /// Waits for the work of a job that has started, and ends the job. Returns the result, or throws what the
  /// work threw.
  std::shared_ptr<Result> take() {
    const std::shared_future<std::shared_ptr<Result>> work = std::exchange(work_, {});
    return work.get();
  }

 private:
  std::shared_future<std::shared_ptr<Result>> work_;
};

}  // namespace palpate
