#pragma once
#include <fmt/core.h>
#include <string_view>
#include <utility>

/// One line a message on stderr. Never from a running loop: loops count, `main` tells.
namespace palpate::log {

/// Names the program in front of every line ("sim_server: ..."). Call once in `main`.
void start(std::string_view program);

void write_info(std::string_view line);
void write_warning(std::string_view line);
void write_error(std::string_view line);

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
