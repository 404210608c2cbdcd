#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace palpate {

/// Destination of the value of an option, which holds the default at first. A `bool` needs no value: it
/// becomes true, or false where the name begins with "!".
using OptionValue = std::variant<bool*, int*, std::uint64_t*, double*, std::string*, std::filesystem::path*,
                                 std::optional<int>*, std::optional<double>*, std::optional<std::string>*,
                                 std::optional<std::filesystem::path>*, std::vector<std::string>*,
                                 std::vector<std::filesystem::path>*>;

/// Bounds of a number, both allowed.
struct Bounds {
  double least = 0, most = 0;
};

/// Rules that few options have.
struct OptionRules {
  bool required = false;
  bool shows_default = false;      ///< in --help
  bool one_at_a_time = false;      ///< of a list: the option is given once for each value
  std::optional<Bounds> within{};  ///< of a number
  std::string needs{};             ///< another option of the same command, declared before
  std::string value_name{};        ///< in --help, in place of the type
};

/// An option "--name" of a command, or its argument "NAME".
struct Option {
  std::string name, help;
  OptionValue value;
  OptionRules rules{};
};

/// A program, or one of its subcommands: its own options and what it does, or subcommands of which one must
/// be given.
struct Command {
  std::string name, summary, footer{};
  std::vector<Option> options{};
  std::function<int()> run{};  ///< returns the exit code; owns what the options point to
  std::vector<Command> commands{};
};

/// Returns the lists joined in order.
std::vector<Option> joined(std::initializer_list<std::vector<Option>> lists);

/// Runs the program that `describe` makes, from the command line: names the log, holds back Ctrl-C, answers
/// --help and --version, says a wrong use in one line (exit code 2), runs the command asked for, and turns an
/// `Error` that escapes into one line on stderr and its exit code. Call from `main` and return the result.
int run_program(const char* name, int argc, char** argv, Command (*describe)());

/// Throws `Error` unless `value` lies in [least, most].
void require_within(double value, double least, double most, const char* option, const char* unit);

/// Throws `Error` unless `value` is finite and at least `least`; `option` and `unit` are for the message.
void require_at_least(double value, double least, const char* option, const char* unit);

}  // namespace palpate
