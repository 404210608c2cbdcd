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

constexpr int kLook = 100;      // ms
constexpr int kMostStill = 15;  // looks without a heartbeat, once there was one

enum class Ending { kGoodbye, kDied, kStopped, kLeftPushing };

bool left_pushing(const Heartbeat& beats) {
  return beats.ticks == Heartbeat::kLeftPushing;
}

/// One loop, as it was seen last.
struct SeenLoop {
  std::uint64_t ticks = 0;
  int still = 0;  // looks

  bool stands_still(const Heartbeat& beats) {
    const std::uint64_t now = beats.ticks;
    still = now == ticks && now > 0 && now < Heartbeat::kLeftPushing ? still + 1 : 0;
    ticks = now;
    return still >= kMostStill;
  }
};

/// Waits until the client says goodbye, dies, or one of its loops stands still or has left its device
/// pushing.
Ending wait_for_end(int pipe, std::span<const Heartbeat> beats) {
  std::vector<SeenLoop> loops(beats.size());
  for (;;) {
    pollfd end{pipe, POLLIN, 0};
    const int ready = poll(&end, 1, kLook);
    char byte;
    if (std::ranges::any_of(beats, left_pushing)) return Ending::kLeftPushing;
    if (ready > 0) return read(pipe, &byte, 1) > 0 ? Ending::kGoodbye : Ending::kDied;
    for (std::size_t i = 0; i < loops.size(); ++i) {
      if (loops[i].stands_still(beats[i])) return Ending::kStopped;
    }
  }
}

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

/// The whole life of the guardian.
void guard(int pipe, pid_t client, std::span<const Heartbeat> beats, std::span<const ClientConfig> configs) {
  setsid();  // a signal to the client's group is not for us
  prctl(PR_SET_NAME, "palpate-guard");
  const Ending ending = wait_for_end(pipe, beats);
  if (ending == Ending::kGoodbye) return;
  if (ending == Ending::kStopped) {
    log::error("the client stands still with a device in its hand; it is ended");
    kill(client, SIGKILL);
  }
  const bool some = ending == Ending::kLeftPushing;   // the client lives, and holds the others
  for (std::size_t i = 0; i < configs.size(); ++i) {  // at the same time: one must not wait for another
    const ClientConfig& config = configs[i];
    if (row_of(config.device).make_safe == nullptr || (some && !left_pushing(beats[i]))) continue;
    const pid_t child = fork();
    if (child > 0) continue;
    make_safe(config, some ? "the device did not take its last zero"
                           : "the client died");  // here, where there can be no other process
    if (child == 0) _exit(0);
  }
  while (wait(nullptr) > 0) {
  }
}

}  // namespace

Guardian::Guardian(std::span<const ClientConfig> configs) {
  const bool needed = std::any_of(configs.begin(), configs.end(), [](const ClientConfig& config) {
    return row_of(config.device).make_safe != nullptr;
  });
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
    guard(ends[0], client, {beats_, configs.size()}, configs);
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
