#include "common/log.h"

#include <memory>
#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <string>

namespace palpate::log {
namespace {

std::shared_ptr<spdlog::logger> named(std::string_view program) {
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  auto logger = std::make_shared<spdlog::logger>(std::string(program), std::move(sink));
  logger->set_pattern("%n: %^%v%$");
  return logger;
}

/// Not spdlog's default one: in somebody else's program that is theirs.
std::shared_ptr<spdlog::logger>& logger() {
  static std::shared_ptr<spdlog::logger> ours = named("palpate");
  return ours;
}

}  // namespace

void start(std::string_view program) {
  logger() = named(program);
}

void report_more() {
  logger()->set_level(spdlog::level::debug);
}

bool is_debugging() {
  return logger()->should_log(spdlog::level::debug);
}

void write_debug(std::string_view line) {
  logger()->debug("debug: {}", line);
}

void write_info(std::string_view line) {
  logger()->info("{}", line);
}

void write_warning(std::string_view line) {
  logger()->warn("warning: {}", line);
}

void write_error(std::string_view line) {
  logger()->error("error: {}", line);
}

}  // namespace palpate::log
