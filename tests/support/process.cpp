#include "tests/support/process.h"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/support/paths.h"

namespace palpate::test {
namespace {

using Clock = std::chrono::steady_clock;

#if defined(PALPATE_SANITIZED)
constexpr double kSlower = 6;  // programs are, under a sanitizer
#else
constexpr double kSlower = 1;
#endif

Clock::time_point in_seconds(double s) {
  s *= kSlower;
  return Clock::now() + std::chrono::milliseconds(static_cast<int>(1e3 * s));
}
void pause() {
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace

Process::Process(const std::string& program, const std::vector<std::string>& arguments) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
  const std::string path = std::filesystem::path(bin_dir()) / program;
  std::vector<char*> argv{const_cast<char*>(path.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    execv(path.c_str(), argv.data());
    _exit(127);
  }
  close(ends[1]);
  pipe_ = ends[0];
  fcntl(pipe_, F_SETFL, O_NONBLOCK);
}

Process::~Process() {
  if (running()) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(pipe_);
}

void Process::signal(int number) const {
  kill(pid_, number);
}

void Process::drain() {
  char buffer[4096];
  for (ssize_t got = 0; (got = read(pipe_, buffer, sizeof buffer)) > 0;)
    output_.append(buffer, static_cast<std::size_t>(got));
}

const std::string& Process::output() {
  drain();
  return output_;
}

bool Process::running() {
  if (ended_) return false;
  int status = 0;
  rusage used{};
  if (wait4(pid_, &status, WNOHANG, &used) != pid_) return true;
  ended_ = true;
  peak_bytes_ = 1024.0 * static_cast<double>(used.ru_maxrss);
  code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return false;
}

int Process::wait(double seconds) {
  for (const auto end = in_seconds(seconds); running(); pause()) {
    drain();
    if (Clock::now() > end) throw std::runtime_error("still running: " + output());
  }
  drain();
  return code_;
}

bool Process::wait_for(const std::string& text, double seconds) {
  for (const auto end = in_seconds(seconds); Clock::now() < end; pause()) {
    if (output().find(text) != std::string::npos) return true;
    if (!running()) break;
  }
  return output().find(text) != std::string::npos;
}

}  // namespace palpate::test
