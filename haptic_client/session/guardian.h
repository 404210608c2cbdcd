#pragma once
#include <span>
#include <sys/types.h>

#include "haptic_client/session/client_config.h"
#include "haptic_client/session/heartbeat.h"

namespace palpate::client {

/// A small process that outlives this one by a moment: when this one dies in any way, SIGSEGV and `kill -9`
/// included, it takes the devices over, sends them zero force and leaves. (libusb cannot be called from a
/// signal handler, and there is none for `kill -9`.) The kernel gives a dead process's devices back within
/// milliseconds. It notices the death by the end of a pipe whose other end only this process holds; a process
/// that was stopped (Ctrl-Z, a debugger) or hangs, by 1.5 s without a heartbeat of one of its loops, and then
/// kills it. It does not react to Ctrl-C, nor to signals to the group of this process. What it cannot help: a
/// frozen machine, the loss of power, a pulled cable. While it guards, this process leaves no core dump,
/// which would hold the device for as long as it is written.
class Guardian {
 public:
  /// Forks, if one of these devices has motors that must not be left alone. Call it before any thread is
  /// started and any device opened. Throws `Error` when the system gives no process.
  explicit Guardian(std::span<const ClientConfig> configs);
  ~Guardian() { dismiss(); }
  /// Ends the guardian, once all loops have ended. It acts only on devices that have a force on their motors
  /// (`Heartbeat`), as it does as soon as one has.
  void dismiss();
  /// Returns the heartbeat for the haptic loop of the device `i` of `configs`; null: nothing is guarded.
  Heartbeat* heartbeat(std::size_t i) const { return beats_ == nullptr ? nullptr : beats_ + i; }
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

 private:
  int pipe_ = -1;  // none: nothing to guard
  pid_t child_ = -1;
  Heartbeat* beats_ = nullptr;  // of each device, shared with the guardian
};

}  // namespace palpate::client
