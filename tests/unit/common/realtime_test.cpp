#include "common/realtime.h"

#include <algorithm>
#include <optional>
#include <sched.h>
#include <string_view>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/support/catch.h"

using namespace palpate;

namespace {

/// How the system schedules a thread after it took a role.
struct Scheduled {
  int policy = -1, priority = -1, nice = -1;
  std::string name, refused;
};

Scheduled scheduled_as(ThreadRole role) {
  Scheduled scheduled;
  std::thread([&] {
    scheduled.refused = take_role(role);
    sched_param param{};
    pthread_getschedparam(pthread_self(), &scheduled.policy, &param);
    scheduled.priority = param.sched_priority;
    scheduled.nice = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
    std::array<char, 16> name{};
    pthread_getname_np(pthread_self(), name.data(), name.size());
    scheduled.name = name.data();
  }).join();
  return scheduled;
}

void waits(const std::stop_token& stop) {
  while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// Returns what `give_roles` says of two threads in a program that may give no real-time priority; nothing
/// where this program cannot give up its right to.
std::optional<std::string> told_without_rights(ThreadRole first, ThreadRole second) {
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  const pid_t child = fork();
  if (child == 0) {
    const rlimit none{0, 0};
    const bool limited =
        setrlimit(RLIMIT_RTPRIO, &none) == 0 && (geteuid() != 0 || setresuid(65534, 65534, 65534) == 0);
    std::string said = limited ? "told:" : "";
    if (limited) {
      std::jthread one(waits), other(waits);
      said += give_roles({{one.native_handle(), first}, {other.native_handle(), second}});
    }
    _exit(write(ends[1], said.data(), said.size()) < 0 ? 1 : 0);
  }
  close(ends[1]);
  std::string said(500, 0);
  said.resize(static_cast<std::size_t>(std::max<ssize_t>(0, read(ends[0], said.data(), said.size()))));
  close(ends[0]);
  waitpid(child, nullptr, 0);
  if (!said.starts_with("told:")) return {};
  return said.substr(5);
}

}  // namespace

TEST_CASE("threads: haptic above network above simulation above all others, the page below all") {
  CHECK(row_of(ThreadRole::kHaptic).realtime == 80);
  CHECK(row_of(ThreadRole::kNetwork).realtime == 50);
  CHECK(row_of(ThreadRole::kSimulation).realtime == 40);
  for (std::size_t i = 1; i < kThreads.size(); ++i) {
    const ThreadRow &above = kThreads[i - 1], &row = kThreads[i];
    CHECK((row.realtime < above.realtime || (row.realtime == 0 && row.nice >= above.nice)));
    CHECK((row.realtime == 0 || row.nice == 0));
    CHECK(std::string_view(row.name).size() <= 15);
  }
  CHECK(kThreads.back().nice > row_of(ThreadRole::kRecording).nice);
}

TEST_CASE("threads: of two roles the first that is refused is told, though the other is granted") {
  const auto told = told_without_rights(ThreadRole::kNetwork, ThreadRole::kHelp);
  if (!told) {
    WARN("this program cannot give up its right to real-time priority");
    return;
  }
  CHECK_THAT(*told, Catch::Contains("for the palpate-net thread"));
  CHECK_THAT(*told_without_rights(ThreadRole::kHelp, ThreadRole::kSimulation),
             Catch::Contains("for the palpate-sim thread"));
  CHECK_THAT(*told_without_rights(ThreadRole::kNetwork, ThreadRole::kSimulation),
             Catch::Contains("for the palpate-net thread"));
  CHECK(told_without_rights(ThreadRole::kHelp, ThreadRole::kHelp) == "");
}

TEST_CASE("threads: each gets the priority of its role, or a sentence says that it did not") {
  const int own = getpriority(PRIO_PROCESS, static_cast<id_t>(getpid()));
  for (const ThreadRow& row : kThreads) {
    CAPTURE(row.name);
    const Scheduled scheduled = scheduled_as(static_cast<ThreadRole>(&row - kThreads.data()));
    CHECK(scheduled.name == row.name);
    CHECK(scheduled.nice == std::min(own + row.nice, 19));
    const bool got = scheduled.refused.empty();
    CHECK((got || row.realtime > 0));
    CHECK(scheduled.policy == (got && row.realtime > 0 ? SCHED_FIFO : SCHED_OTHER));
    CHECK(scheduled.priority == (got ? row.realtime : 0));
    if (!got) CHECK_THAT(scheduled.refused, Catch::Contains(row.name) && Catch::Contains("ulimit -r"));
  }
}
