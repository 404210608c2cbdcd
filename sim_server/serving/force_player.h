#pragma once
#include <atomic>
#include <stop_token>

#include "sim_server/serving/captured_forces.h"
#include "sim_server/serving/sim_loop.h"

namespace palpate::sim {

/// Plays captured forces to whoever holds tool 0, in the place of `SimLoop`: each as long after the first
/// tool state of a session as it was captured after the first sample. Each answers the newest tool state and
/// says that it was computed there; the force is that of the capture, wherever the tool is now. It carries no
/// tangents and no surface: those were of another place.
class ForcePlayer {
 public:
  ForcePlayer(const CapturedForces& forces, SimMailboxes& mailboxes)
      : forces_(forces), mailboxes_(mailboxes) {}

  /// Plays until asked to stop; a new session begins at the first sample. Its own thread.
  void run(const std::stop_token& stop) noexcept;

  /// Samples played in the present or last session, and whether it came to the end. For a watching thread.
  std::atomic<std::uint64_t> played{0};
  std::atomic<bool> ended{false};

 private:
  void poll() noexcept;

  const CapturedForces& forces_;
  SimMailboxes& mailboxes_;
  SessionInput input_;
  std::uint64_t session_ = 0;
  std::size_t next_ = 0;
  Time start_{};
};

}  // namespace palpate::sim
