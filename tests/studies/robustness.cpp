// One cell of the robustness study: an extreme scene with one model.
#include "tests/studies/robustness.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/report.h"
#include "common/text.h"
#include "tests/studies/studies.h"

using namespace palpate;
using namespace palpate::studies;

namespace {

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
  const Case& row = find_row(cases(), name, "case", "robustness");
  const Column& column = find_row(columns(), model, "model", "robustness");
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

Command palpate::studies::robustness_command() {
  struct Options {
    std::string name, model;
    bool quick = false;
  };
  const auto options = std::make_shared<Options>();
  return {.name = "robustness",
          .summary = "Runs one cell, an extreme scene with one model, and prints its row as JSON",
          .footer = "Example: studies robustness teleported \"implicit neo_hookean\"",
          .options = {{"CASE",
                       "Name of a case; \"list\": prints cases and models",
                       &options->name,
                       {.required = true}},
                      {"MODEL", "Deformation model, with its law where it takes several", &options->model},
                      quick_option(options->quick)},
          .run = [options] {
            if (options->name == "list")
              list(options->quick);
            else
              run(options->name, options->model, options->quick);
            return 0;
          }};
}
