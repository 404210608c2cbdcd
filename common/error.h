#pragma once
#include <fmt/core.h>
#include <stdexcept>
#include <string>
#include <utility>

namespace palpate {

/// Set-up found something wrong: one sentence that says what, where and what to do. Thrown only while a
/// program is being built from its inputs, caught once in each `main`; running loops never throw.
class Error : public std::runtime_error {
 public:
  enum class Kind {
    kInput = 2,  ///< wrong use or wrong input: exit code 2
    kRun = 1,    ///< failed at run time (port taken, nobody answers): exit code 1
  };

  explicit Error(const std::string& what, Kind kind = Kind::kInput) : std::runtime_error(what), kind_(kind) {}

  /// The exit code of the program that stops on this error.
  int exit_code() const { return static_cast<int>(kind_); }

 private:
  Kind kind_;
};

/// Throws an `Error` for wrong input, formatted.
template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...));
}

/// Throws an `Error` for a failure at run time, formatted.
template <class... Args>
[[noreturn]] void fail_at_run_time(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...), Error::Kind::kRun);
}

}  // namespace palpate
