// One cell of the robustness study: an extreme scene with one model. Run by `scripts/study robustness`; the
// same arguments give the same bytes.
#include "tests/studies/robustness.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/error.h"
#include "common/log.h"
#include "common/report.h"
#include "common/text.h"

using namespace palpate;
using namespace palpate::studies;

namespace {

constexpr const char* kUsage =
    "usage: robustness_study [--quick] list          a line for each case: its name, and what it is\n"
    "       robustness_study [--quick] CASE MODEL    runs one cell and prints its row as JSON\n"
    "example: robustness_study teleported \"implicit neo_hookean\"\n";

/// To three digits: the rest is rounding, which other processors may do otherwise.
Json rounded(const std::optional<double>& value) {
  if (!value) return nullptr;
  return std::stod(fmt::format("{:.2e}", *value));
}

void list(bool quick) {
  Json all{{"models", Json::array()}, {"cases", Json::array()}};
  for (const Column& column : columns()) all["models"].push_back(column.name);
  for (const Case& row : cases()) {
    if (row.quick || !quick) all["cases"].push_back({{"case", row.name}, {"what", row.what}});
  }
  fmt::print("{}\n", all.dump());
}

void run(const std::string& name, const std::string& model, bool quick) {
  const Case& row = find_row(cases(), name, "case", "robustness_study");
  const Column& column = find_row(columns(), model, "model", "robustness_study");
  const Verdict verdict = row.run(row, column, quick);
  const Json json{{"case", row.name},
                  {"model", column.name},
                  {"outcome", verdict.outcome},
                  {"reason", verdict.reason},
                  {"error_percent", rounded(verdict.error_percent)},
                  {"max_force_newton", rounded(verdict.max_newton)},
                  {"reference", verdict.reference}};
  fmt::print("{}\n", json.dump());
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool quick = !arguments.empty() && arguments.front() == "--quick";
  if (quick) arguments.erase(arguments.begin());
  const bool lists = arguments == std::vector<std::string>{"list"};
  if (!arguments.empty() && (arguments.front() == "-h" || arguments.front() == "--help")) {
    fmt::print("{}", kUsage);
    return 0;
  }
  if (!lists && arguments.size() != 2) {
    fmt::print(stderr, "{}", kUsage);
    return 2;
  }
  log::start("robustness_study");
  try {
    if (lists) {
      list(quick);
    } else {
      run(arguments[0], arguments[1], quick);
    }
  } catch (const Error& e) {
    fmt::print(stderr, "robustness_study: {}\n", e.what());
    return e.exit_code();
  }
  return 0;
}
