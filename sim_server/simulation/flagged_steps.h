#pragma once
#include <cstdint>
#include <string>

#include "common/report.h"

namespace palpate::sim {

/// Steps with a flagged answer, by the first of these reasons that holds.
struct FlaggedSteps {
  std::uint64_t threw = 0;         ///< the model did (`StepFailures`)
  std::uint64_t ran_away = 0;      ///< the surface is farther from rest than any tissue goes
  std::uint64_t inside_out = 0;    ///< elements stay turned inside out: too much for this law of the tissue
  std::uint64_t not_balanced = 0;  ///< the model found no equilibrium under the loads
  std::uint64_t tools = 0;         ///< the contacts of several tools did not settle together
  std::uint64_t contact = 0;       ///< that of one tool did not, or it is unknown where it touches
  /// Returns the steps since `before`.
  FlaggedSteps operator-(const FlaggedSteps& before) const {
    return {threw - before.threw,           ran_away - before.ran_away,
            inside_out - before.inside_out, not_balanced - before.not_balanced,
            tools - before.tools,           contact - before.contact};
  }
  /// "3 not balanced, 1 contact not settled", with what helps; empty: none.
  std::string to_text() const;
  /// Returns the counts for reports: {"threw": ...}.
  Json to_json() const;
};

}  // namespace palpate::sim
