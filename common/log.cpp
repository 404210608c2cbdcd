#include "common/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <string>

namespace palpate::log {

void start(std::string_view program) {
  auto logger = spdlog::stderr_color_mt(std::string(program));
  logger->set_pattern("%n: %^%v%$");
  spdlog::set_default_logger(std::move(logger));
}

void write_info(std::string_view line) {
  spdlog::info("{}", line);
}

void write_warning(std::string_view line) {
  spdlog::warn("warning: {}", line);
}

void write_error(std::string_view line) {
  spdlog::error("error: {}", line);
}

}  // namespace palpate::log
