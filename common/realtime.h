#pragma once
#include <pthread.h>
#include <string>

namespace palpate {

/// Real-time priorities (SCHED_FIFO) of both programs: a haptic tick waits for nobody; a force that waits
/// behind a step of the simulation is older than it need be.
inline constexpr int kHapticPriority = 80, kNetworkPriority = 50, kSimulationPriority = 40;

/// Locks the program's memory (mlockall) so that no page fault stalls a loop. Returns an empty text, or one
/// sentence that says what the system refused and what to change. Call once, after set-up.
std::string lock_memory();

/// Gives the calling thread a name (at most 15 characters, shown by `top -H`).
void name_thread(const char* name);

/// Gives a thread real-time priority (SCHED_FIFO `priority`, 1..99) and the name `name` (at most 15
/// characters, shown by `top -H`). Returns an empty text, or one sentence that says what was refused and what
/// to change.
std::string make_realtime(pthread_t thread, const char* name, int priority);

/// Gives the calling thread, which the thread that started it may have given real-time priority, the ordinary
/// one, and a name as above.
void make_ordinary(const char* name);

/// Lets the calling thread, which the thread that started it may have given real-time priority, work beside
/// all others: no real time, and less of the processor where that is scarce. With a name as above.
void make_background(const char* name);

}  // namespace palpate
