#include "sim_server/simulation/flagged_steps.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string_view>

namespace palpate::sim {

void FlaggedSteps::count(Doubt why) noexcept {
  constexpr std::array kCounts{
      &FlaggedSteps::threw, &FlaggedSteps::ran_away, &FlaggedSteps::inside_out,   &FlaggedSteps::not_balanced,
      &FlaggedSteps::tools, &FlaggedSteps::contact,  &FlaggedSteps::outside_reach};
  ++(this->*kCounts[static_cast<std::size_t>(why)]);
}

std::string FlaggedSteps::to_text() const {
  std::string text;
  const auto add = [&](std::uint64_t steps, std::string_view reason) {
    if (steps > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", steps, reason);
  };
  add(threw, "failed");
  add(ran_away, "ran away");
  add(inside_out, "with elements inside out (law \"neo_hookean\" lets none turn)");
  add(not_balanced, "not balanced");
  add(tools, "tools not settled together");
  add(contact, "contact not settled");
  add(outside_reach,
      fmt::format("with the tool in tissue that its `reach` leaves out, by up to {:.1f} mm (widen "
                  "`reach`, or move the tool's way)",
                  1e3 * deepest));
  return text;
}

Json FlaggedSteps::to_json() const {
  return {{"threw", threw},
          {"ran_away", ran_away},
          {"inside_out", inside_out},
          {"not_balanced", not_balanced},
          {"tools", tools},
          {"contact", contact},
          {"outside_reach", outside_reach}};
}

}  // namespace palpate::sim
