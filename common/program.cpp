#include "common/program.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "common/error.h"
#include "common/interrupt.h"
#include "common/log.h"

namespace palpate {

int run_program(const char* name, int argc, char** argv, int (*body)(int argc, char** argv)) {
  log::start(name);
  block_interrupts();
  try {
    return body(argc, argv);
  } catch (const Error& e) {
    log::error("{}", e.what());
    return e.exit_code();
  } catch (const std::exception& e) {
    log::error("{}", e.what());
    return 1;
  }
}

std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv) {
  app.set_version_flag("--version", "palpate " PALPATE_VERSION);
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    log::error("{}; try --help", e.what());
    return 2;
  }
}

void require_within(double value, double least, double most, const char* option, const char* unit) {
  if (!(value >= least && value <= most))
    fail("{}: expected {} to {} {}, not {}", option, least, most, unit, value);
}

void require_at_least(double value, double least, const char* option, const char* unit) {
  if (!std::isfinite(value) || value < least)
    fail("{}: expected at least {} {}, not {}", option, least, unit, value);
}

}  // namespace palpate
