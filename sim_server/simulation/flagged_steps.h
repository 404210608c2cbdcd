#pragma once
#include <cstdint>
#include <string>

#include "common/doubt.h"
#include "common/report.h"

namespace palpate::sim {

/// Steps with a flagged answer, by the first of these reasons that holds.
struct FlaggedSteps {
  void count(Doubt why) noexcept;
  std::uint64_t threw = 0;          ///< the model did (`StepFailures`)
  std::uint64_t ran_away = 0;       ///< the surface is farther from rest than any tissue goes
  std::uint64_t inside_out = 0;     ///< elements stay turned inside out: too much for this law of the tissue
  std::uint64_t not_balanced = 0;   ///< the model found no equilibrium under the loads
  std::uint64_t tools = 0;          ///< the contacts of several tools did not settle together
  std::uint64_t contact = 0;        ///< that of one tool did not, or it is unknown where it touches
  std::uint64_t outside_reach = 0;  ///< a tool was in tissue that its `reach` leaves out
  double deepest = 0;               ///< of these, how far its surface was in there, m
  /// Returns the steps since `before`.
  FlaggedSteps operator-(const FlaggedSteps& before) const {
    return {threw - before.threw,
            ran_away - before.ran_away,
            inside_out - before.inside_out,
            not_balanced - before.not_balanced,
            tools - before.tools,
            contact - before.contact,
            outside_reach - before.outside_reach,
            deepest};
  }
  /// "3 not balanced, 1 contact not settled", with what helps; empty: none.
  std::string to_text() const;
  /// Returns the counts for reports: {"threw": ...}.
  Json to_json() const;
};

}  // namespace palpate::sim
