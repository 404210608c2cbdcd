#pragma once
#include <span>
#include <sys/types.h>

#include "haptic_client/client_config.h"

namespace palpate::client {

/// A small process that outlives this one by a moment: when this one dies in any way, SIGSEGV and `kill -9`
/// included, it takes the devices over, sends them zero force and leaves. (libusb cannot be called from a
/// signal handler, and there is none for `kill -9`.) The kernel gives a dead process's devices back within
/// milliseconds. It notices the death by the end of a pipe whose other end only this process holds, and does
/// not react to Ctrl-C, nor to signals to the group of this process. What it cannot help: a stopped or frozen
/// process, the loss of power, a pulled cable.
class Guardian {
 public:
  /// Forks, if one of these devices has motors that must not be left alone. Call it before any thread is
  /// started and any device opened. Throws `Error` when the system gives no process.
  explicit Guardian(std::span<const ClientConfig> configs);
  /// All is well: the devices have had their zero. The guardian goes without touching them.
  ~Guardian();
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

 private:
  int pipe_ = -1;  // none: nothing to guard
  pid_t child_ = -1;
};

}  // namespace palpate::client
