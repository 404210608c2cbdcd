#pragma once
#include <string>
#include <sys/types.h>
#include <vector>

namespace palpate::test {

/// A child process with its output collected; killed if it still runs when this goes.
class Process {
 public:
  /// Starts `program` (in build/.../bin, unless its path is absolute) with `arguments`.
  Process(const std::string& program, const std::vector<std::string>& arguments);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const;
  pid_t id() const { return pid_; }
  bool running();
  /// Waits for the end and returns the exit code, or -signal. Fails the test after `seconds`.
  int wait(double seconds = 20);
  /// Waits until the output (stdout and stderr together) contains `text`; false after `seconds`.
  bool wait_for(const std::string& text, double seconds = 20);
  /// All output so far.
  const std::string& output();
  /// Most memory that it held resident, bytes, as the system counted it; once it has ended.
  double peak_bytes() const { return peak_bytes_; }

 private:
  void drain();
  pid_t pid_ = -1;
  int pipe_ = -1;
  int code_ = 0;
  bool ended_ = false;
  double peak_bytes_ = 0;
  std::string output_;
};

}  // namespace palpate::test
