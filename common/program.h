#pragma once
#include <optional>

namespace CLI {
class App;
}

namespace palpate {

/// What both programs do around their own work: name the log, hold back Ctrl-C, and turn an `Error` that
/// escapes `body` into one line on stderr and its exit code. Call from `main` and return the result.
int run_program(const char* name, int argc, char** argv, int (*body)(int argc, char** argv));

/// Parses the command line, after adding `--version`. Returns the exit code if the program should end now: 0
/// after
/// --help or --version, 2 after a wrong use, said in one line.
std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv);

/// Throws `Error` unless `value` lies in [least, most].
void require_within(double value, double least, double most, const char* option, const char* unit);

/// Throws `Error` unless `value` is finite and at least `least`; `option` and `unit` are for the message.
void require_at_least(double value, double least, const char* option, const char* unit);

}  // namespace palpate
