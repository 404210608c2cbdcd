#include "common/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "common/error.h"
#include "common/interrupt.h"
#include "common/log.h"
#include "common/text.h"

namespace palpate {
namespace {

/// `; did you mean "run"?` where the first word is no subcommand of a program that wants one.
std::string meant(const CLI::App& app, int argc, char** argv) {
  if (app.get_require_subcommand_min() == 0 || argc < 2 || argv[1][0] == '-') return {};
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  if (std::ranges::find(names, argv[1]) != names.end()) return {};
  return fmt::format(": \"{}\" is none{}", argv[1], suggestion(argv[1], names));
}

}  // namespace

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
  app.add_flag_callback("--debug", log::tell_more,
                        "Before the subcommand: tell more, as what the link did in each second");
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    log::error("{}{}; try --help", e.what(), meant(app, argc, argv));
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
