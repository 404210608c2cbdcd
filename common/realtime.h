#pragma once
#include <array>
#include <initializer_list>
#include <pthread.h>
#include <string>
#include <utility>

namespace palpate {

/// Task of a thread, in the order of priority: a thread waits for none of those below it.
enum class ThreadRole {
  kHaptic,      ///< a tick waits for nobody
  kNetwork,     ///< a force that waits behind a step of the simulation is older than it need be
  kSimulation,  ///< steps
  kHelp,        ///< shares in the work of another thread
  kRecording,   ///< writes a capture
  kPage,        ///< the live page, and work in the background: they may be late, forces may not
};

/// Priorities of a role.
struct ThreadRow {
  const char* name;  ///< as `top -H` shows it, at most 15 characters
  int realtime;      ///< SCHED_FIFO, 1..99; 0: an ordinary thread
  int nice;          ///< of an ordinary thread: how much it gives way to others of the program
};
/// A row for each role, in their order.
inline constexpr std::array<ThreadRow, 6> kThreads{{{"palpate-haptic", 80, 0},
                                                    {"palpate-net", 50, 0},
                                                    {"palpate-sim", 40, 0},
                                                    {"palpate-help", 0, 0},
                                                    {"palpate-record", 0, 0},
                                                    {"palpate-view", 0, 10}}};
constexpr const ThreadRow& row_of(ThreadRole role) {
  return kThreads[static_cast<std::size_t>(role)];
}

/// Locks the program's memory (mlockall) so that no page fault stalls a loop. Returns an empty text, or one
/// sentence that says what the system refused and what to change. Call once, after set-up.
std::string lock_memory();

/// Gives the calling thread, which may have the priority of the thread that started it, that of its role, and
/// its name; `name`: another one. Returns an empty text, or one sentence that says what was refused and what
/// to change.
std::string take_role(ThreadRole role, const char* name = nullptr);
/// Gives another thread, of a role with real-time priority, the same.
std::string give_role(pthread_t thread, ThreadRole role);
/// Gives several the same. Returns an empty text if each got it, or the sentence of the first that did not.
std::string give_roles(std::initializer_list<std::pair<pthread_t, ThreadRole>> threads);

}  // namespace palpate
