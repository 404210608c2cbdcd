#include "haptic_client/session/guardian.h"

#include <algorithm>
#include <csignal>
#include <fcntl.h>
#include <memory>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "common/error.h"
#include "common/log.h"

namespace palpate::client {
namespace {

constexpr int kPollPeriod = 100;  // ms
constexpr int kMaxIdle = 15;      // looks without a heartbeat, once there was one

/// One loop, as it was seen last.
struct SeenLoop {
  std::uint64_t ticks = 0;
  int idle = 0;  // looks

  bool is_idle(const Heartbeat& beats) {
    const std::uint64_t now = beats.ticks;
    idle = now == ticks && now > 0 && now < Heartbeat::kReleasedPushing ? idle + 1 : 0;
    ticks = now;
    return idle >= kMaxIdle;
  }
};

void make_safe(const ClientConfig& config, const char* why) {
  const std::string name = config.device.name + (config.device.port.empty() ? "" : ":") + config.device.port;
  try {
    if (row_of(config.device).make_safe(config.device) == 0)
      fail_at_run_time("it is not plugged in, or another program holds it");
    log::warning("{}; zero force sent to {}", why, name);
  } catch (const std::exception& e) {
    log::error("{}; {} could not be taken over ({}): if it still pushes, switch it off", why, name, e.what());
  }
}

/// The devices of a client, each until it was taken over.
class Guarded {
 public:
  Guarded(std::span<const ClientConfig> configs, std::span<const Heartbeat> beats)
      : configs_(configs), beats_(beats), loops_(configs.size()), taken_(configs.size(), 0) {}

  /// Those whose loop is over, and has left them pushing: the client lives, and holds the others.
  void take_released_pushing() {
    for (std::size_t i = 0; i < configs_.size(); ++i) {
      if (beats_[i].ticks == Heartbeat::kReleasedPushing) take(i, "the device did not take its last zero");
    }
  }
  void take_all() {
    for (std::size_t i = 0; i < configs_.size(); ++i) take(i, "the client died");
  }
  /// True if a loop stands still; to be asked at each look.
  bool is_idle() {
    bool idle = false;
    for (std::size_t i = 0; i < loops_.size(); ++i) idle |= loops_[i].is_idle(beats_[i]);
    return idle;
  }

 private:
  /// Switches the force of a tool off in a process of its own: one must not wait for another.
  void take(std::size_t i, const char* why) {
    if (taken_[i] != 0 || row_of(configs_[i].device).make_safe == nullptr) return;
    taken_[i] = 1;
    const pid_t child = fork();
    if (child > 0) return;
    make_safe(configs_[i], why);  // here, where there can be no other process
    if (child == 0) _exit(0);
  }

  std::span<const ClientConfig> configs_;
  std::span<const Heartbeat> beats_;
  std::vector<SeenLoop> loops_;
  std::vector<char> taken_;
};

/// The whole life of the guardian: until the client says goodbye, dies, or one of its loops stands still.
void guard(int pipe, pid_t client, Guarded guarded) {
  setsid();  // a signal to the client's group is not for us
  prctl(PR_SET_NAME, "palpate-guard");
  for (bool over = false; !over;) {
    pollfd end{pipe, POLLIN, 0};
    over = poll(&end, 1, kPollPeriod) > 0;
    guarded.take_released_pushing();  // also where it says goodbye, which it does after
    char byte;
    if (over) {
      if (read(pipe, &byte, 1) <= 0) guarded.take_all();
    } else if (guarded.is_idle()) {
      log::error("the client stands still with a device in its hand; it is ended");
      kill(client, SIGKILL);
      guarded.take_all();
      over = true;
    }
  }
  while (wait(nullptr) > 0) {
  }
}

}  // namespace

Guardian::Guardian(std::span<const ClientConfig> configs) {
  const bool needed = std::ranges::any_of(
      configs, [](const ClientConfig& config) { return row_of(config.device).make_safe != nullptr; });
  if (!needed) return;
  void* const page = mmap(nullptr, configs.size() * sizeof *beats_, PROT_READ | PROT_WRITE,
                          MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) fail_at_run_time("no memory for the guardian process");
  beats_ = static_cast<Heartbeat*>(page);
  std::uninitialized_default_construct_n(beats_, configs.size());
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail_at_run_time("no pipe for the guardian process; too many open files?");
  const pid_t client = getpid();
  child_ = fork();
  if (child_ < 0) fail_at_run_time("no guardian process could be started; too many processes?");
  if (child_ == 0) {
    close(ends[1]);
    guard(ends[0], client, Guarded(configs, {beats_, configs.size()}));
    _exit(0);
  }
  close(ends[0]);
  pipe_ = ends[1];
  prctl(PR_SET_DUMPABLE, 0);
}

void Guardian::dismiss() {
  if (pipe_ < 0) return;
  const char goodbye = 1;
  while (write(pipe_, &goodbye, 1) < 0 && errno == EINTR) {
  }
  close(pipe_);
  pipe_ = -1;
  waitpid(child_, nullptr, 0);
}

}  // namespace palpate::client
