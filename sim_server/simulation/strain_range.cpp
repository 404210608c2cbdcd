#include "sim_server/simulation/strain_range.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string_view>

namespace palpate::sim {
namespace {

/// What follows tissue farther, in words.
std::string_view advice(ElasticLaw law) {
  switch (law) {
    case ElasticLaw::kLinear:
    case ElasticLaw::kCorotational:
    case ElasticLaw::kStVenantKirchhoff:
      return "law \"neo_hookean\" follows farther, and so does a blunter tip";
    case ElasticLaw::kNeoHookean:
      break;
  }
  return "a blunter tip, or a finer mesh there, strains less";
}

}  // namespace

double meant_strain(ElasticLaw law) noexcept {
  switch (law) {
    case ElasticLaw::kLinear:
    case ElasticLaw::kCorotational:
      return 0.2;
    case ElasticLaw::kStVenantKirchhoff:
      return 0.42;
    case ElasticLaw::kNeoHookean:
      break;
  }
  return 0.5;
}

bool StrainRange::add(double strain) noexcept {
  ++steps_;
  largest_ = std::max(largest_, strain);
  const bool beyond = !(strain <= meant_strain(law_));
  beyond_ += beyond ? 1 : 0;
  return beyond;
}

bool StrainRange::is_inside_out(double strain, double area) const noexcept {
  constexpr double kTorn = 3;  // edges four times as long; shipped scenes stay below 0.6
  return law_ == ElasticLaw::kLinear && !(area > 0 && strain <= kTorn);
}

std::string StrainRange::to_text() const {
  if (beyond_ == 0) return "";
  return fmt::format(
      "strain up to {:.0f} % of the surface under tools, in {} of {} steps in contact beyond the {:.0f} "
      "% that the law of this tissue is meant for: {}",
      100 * largest_, beyond_, steps_, 100 * meant_strain(law_), advice(law_));
}

Json StrainRange::to_json() const {
  return {{"largest", largest_}, {"meant", meant_strain(law_)}, {"steps", steps_}, {"beyond_steps", beyond_}};
}

}  // namespace palpate::sim
