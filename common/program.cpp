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

/// The option itself, by the type of its value.
struct Adder {
  CLI::App& app;
  const Option& option;

  CLI::Option* operator()(bool* value) const { return app.add_flag(option.name, *value, option.help); }
  template <class Value>
  CLI::Option* operator()(Value* value) const {
    return app.add_option(option.name, *value, option.help);
  }
};

bool is_complete(const OptionValue& value) {
  return std::holds_alternative<int*>(value) || std::holds_alternative<std::uint64_t*>(value) ||
         std::holds_alternative<std::optional<int>*>(value);
}

CLI::Range range_of(const Bounds& bounds, const OptionValue& value) {
  if (is_complete(value)) return {static_cast<int>(bounds.least), static_cast<int>(bounds.most)};
  return {bounds.least, bounds.most};
}

void declare(CLI::App& app, const Option& option) {
  CLI::Option* const added = std::visit(Adder{app, option}, option.value);
  const OptionRules& rules = option.rules;
  if (rules.required) added->required();
  if (rules.one_at_a_time) added->allow_extra_args(false);
  if (rules.within) added->check(range_of(*rules.within, option.value));
  if (rules.shows_default) added->capture_default_str();
  if (!rules.needs.empty()) added->needs(app.get_option(rules.needs));
  if (!rules.value_name.empty()) added->type_name(rules.value_name);
}

void declare(CLI::App& app, const Command& command) {
  if (!command.commands.empty()) app.require_subcommand(1);
  app.footer(command.footer);
  for (const Option& option : command.options) declare(app, option);
  for (const Command& each : command.commands) declare(*app.add_subcommand(each.name, each.summary), each);
}

/// Parses the command line, after adding `--version` and `--debug`. Returns the exit code if the program
/// should end now: 0 after --help or --version, 2 after a wrong use, said in one line.
std::optional<int> parse(CLI::App& app, int argc, char** argv) {
  app.set_version_flag("--version", "palpate " PALPATE_VERSION);
  app.add_flag_callback("--debug", log::report_more,
                        "Before the subcommand: print more, such as what the link did in each second");
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

/// The innermost of the subcommands that were given; the program itself where it has none.
const Command& chosen(const CLI::App& app, const Command& command) {
  for (const Command& each : command.commands)
    if (app.got_subcommand(each.name)) return chosen(*app.get_subcommand(each.name), each);
  return command;
}

}  // namespace

std::vector<Option> joined(std::initializer_list<std::vector<Option>> lists) {
  std::vector<Option> all;
  for (const std::vector<Option>& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

int run_program(const char* name, int argc, char** argv, Command (*describe)()) {
  log::start(name);
  block_interrupts();
  try {
    const Command program = describe();
    CLI::App app{program.summary};
    declare(app, program);
    if (const auto ended = parse(app, argc, argv)) return *ended;
    return chosen(app, program).run();
  } catch (const Error& e) {
    log::error("{}", e.what());
    return e.exit_code();
  } catch (const std::exception& e) {
    log::error("{}", e.what());
    return 1;
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
