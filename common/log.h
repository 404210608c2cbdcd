#pragma once
#include <fmt/core.h>
#include <string_view>
#include <utility>

/// Messages on stderr, one a line. Never from a running loop: loops count, `main` prints.
namespace palpate::log {

/// Names the program in front of every line ("sim_server: ..."). Call once in `main`.
void start(std::string_view program);

/// Writes debug lines, too, from this call on.
void report_more();
/// True if debug lines are written.
bool is_debugging();

void write_debug(std::string_view line);
void write_info(std::string_view line);
void write_warning(std::string_view line);
void write_error(std::string_view line);

template <class... Args>
void debug(fmt::format_string<Args...> format, Args&&... args) {
  if (is_debugging()) write_debug(fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void info(fmt::format_string<Args...> format, Args&&... args) {
  write_info(fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void warning(fmt::format_string<Args...> format, Args&&... args) {
  write_warning(fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void error(fmt::format_string<Args...> format, Args&&... args) {
  write_error(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace palpate::log
