#include "haptic_client/guardian.h"

#include <algorithm>
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.h"
#include "common/log.h"
#include "common/text.h"

namespace palpate::client {
namespace {

const DeviceRow& row_of(const ClientConfig& config) {
  return find_row(devices(), config.device.name, "device", config.device.where);
}

/// Waits for the end of the pipe; true when the client said goodbye before.
bool said_goodbye(int pipe) {
  char byte;
  ssize_t got;
  do {
    got = read(pipe, &byte, 1);
  } while (got < 0 && errno == EINTR);
  return got > 0;
}

/// The whole life of the guardian.
void guard(int pipe, std::span<const ClientConfig> configs) {
  setsid();  // a signal to the client's group is not for us
  prctl(PR_SET_NAME, "palpate-guard");
  if (said_goodbye(pipe)) return;
  for (const ClientConfig& config : configs) {
    if (row_of(config).make_safe == nullptr) continue;
    const std::string name =
        config.device.name + (config.device.port.empty() ? "" : ":") + config.device.port;
    try {
      if (row_of(config).make_safe(config.device) == 0) fail_at_run_time("it does not answer");
      log::warning("the client died; zero force sent to {}", name);
    } catch (const std::exception& e) {
      log::error("the client died, and {} could not be taken over ({}): switch it off", name, e.what());
    }
  }
}

}  // namespace

Guardian::Guardian(std::span<const ClientConfig> configs) {
  const bool needed = std::any_of(configs.begin(), configs.end(), [](const ClientConfig& config) {
    return row_of(config).make_safe != nullptr;
  });
  if (!needed) return;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail_at_run_time("no pipe for the guardian process; too many open files?");
  child_ = fork();
  if (child_ < 0) fail_at_run_time("no guardian process could be started; too many processes?");
  if (child_ == 0) {
    close(ends[1]);
    guard(ends[0], configs);
    _exit(0);
  }
  close(ends[0]);
  pipe_ = ends[1];
}

Guardian::~Guardian() {
  if (pipe_ < 0) return;
  const char goodbye = 1;
  while (write(pipe_, &goodbye, 1) < 0 && errno == EINTR) {
  }
  close(pipe_);
  waitpid(child_, nullptr, 0);
}

}  // namespace palpate::client
